// Which of several profiles a pixel scatters by: the lowest three bits of its viewz. What they take from it is below a
// millionth of the distance.
float profile_encode(float z, uint profile) {
    return uintBitsToFloat(floatBitsToUint(z) & ~7u | profile);
}

uint profile_of(float z) {
    return floatBitsToUint(z) & 7u;
}
