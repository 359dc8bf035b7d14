//! Mutations of a document that leave it a document.

use serde_json::{Value, json};

/// Pseudo-random numbers.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// A document (plain, or the first chunk of a GLB) with one to four of its values changed; `None` where it is none, or grows
/// beyond `most` bytes.
pub fn mutate(bytes: &[u8], most: usize, seed: u64) -> Option<Vec<u8>> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
    let binary = bytes.starts_with(b"glTF");
    let (text, rest) = if binary {
        let length = word(12)?;
        (bytes.get(20..20 + length)?, &bytes[20 + length..])
    } else {
        (bytes, &[][..])
    };
    let mut document: Value = serde_json::from_slice(text).ok()?;
    let mut dice = Dice(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1);
    for _ in 0..1 + dice.below(4) {
        let pick = dice.below(count(&document));
        let donor = nth(&mut document, &mut dice.below(usize::MAX).min(pick))?.clone();
        let target = dice.below(count(&document));
        change(nth(&mut document, &mut { target })?, donor, &mut dice);
    }
    let out = if binary { super::glb::write(&document, rest) } else { document.to_string().into_bytes() };
    (out.len() <= most).then_some(out)
}

fn children(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Array(items) => items.iter_mut().collect(),
        Value::Object(members) => members.iter_mut().map(|(_, v)| v).collect(),
        _ => Vec::new(),
    }
}

fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(items) => items.iter().map(count).sum::<usize>(),
        Value::Object(members) => members.values().map(count).sum(),
        _ => 0,
    }
}

fn nth<'a>(value: &'a mut Value, left: &mut usize) -> Option<&'a mut Value> {
    if *left == 0 {
        return Some(value);
    }
    *left -= 1;
    children(value).into_iter().find_map(|child| {
        let within = count(child);
        if *left < within {
            return nth(child, left);
        }
        *left -= within;
        None
    })
}

fn change(value: &mut Value, donor: Value, dice: &mut Dice) {
    const NUMBERS: [f64; 14] =
        [0., 1., -1., 2., 3., 0.5, 255., 256., 65535., 65536., 4294967295., 1e9, 1e300, 9007199254740993.];
    let number = json!(NUMBERS[dice.below(NUMBERS.len())]);
    match value {
        Value::Array(items) => match dice.below(4) {
            0 if !items.is_empty() => drop(items.remove(dice.below(items.len()))),
            1 if !items.is_empty() => items.push(items[dice.below(items.len())].clone()),
            2 => items.push(donor),
            _ => *value = donor,
        },
        Value::Object(members) => {
            let keys: Vec<String> = members.keys().cloned().collect();
            match (keys.get(dice.below(keys.len())), dice.below(3)) {
                (Some(key), 0) => drop(members.remove(key)),
                (Some(key), 1) => drop(members.insert(key.clone(), donor)),
                _ => *value = donor,
            }
        }
        Value::Number(n) if dice.below(2) == 0 => {
            // Whole numbers stay so: most are counts and indices.
            let near = n.as_i64().map(|n| json!(n.saturating_add(dice.below(5) as i64 - 2)));
            *value = near.unwrap_or(number);
        }
        Value::Number(_) => *value = number,
        _ => *value = donor,
    }
}
