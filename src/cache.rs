//! What is dear to make and the same the next time, kept in files: pipelines as the driver compiled them, the kernel's mass of
//! a mesh, the table of a profile. A file that is damaged, cut off, or of another key is not there, and is replaced.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// First bytes of every file.
const MAGIC: &[u8; 8] = b"pdsscch1";

/// A folder of kept things.
#[derive(Clone, Debug)]
pub struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// In this folder, which is made when something is kept.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Cache {
        Cache { folder: folder.into() }
    }

    /// The user's: `$XDG_CACHE_HOME/pdss`, else `~/.cache/pdss` (XDG Base Directory Specification 0.8). None without a home.
    pub fn of_user() -> Option<Cache> {
        let set = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
        let base = set("XDG_CACHE_HOME").or_else(|| Some(set("HOME")?.join(".cache")))?;
        Some(Cache::in_folder(base.join("pdss")))
    }

    /// What was kept under this kind and key; none where nothing was, or nothing whole.
    pub fn read(&self, kind: &str, key: u64) -> Option<Vec<u8>> {
        let mut bytes = fs::read(self.path(kind, key)).ok()?;
        let number = |at: usize| Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?));
        let whole = bytes.starts_with(MAGIC) && number(8)? == key && number(16)? == hash(&[bytes.get(24..)?]);
        whole.then(|| bytes.split_off(24))
    }

    /// Keeps it, whole or not at all. Nobody is told where that fails: it is made again the next time.
    pub fn write(&self, kind: &str, key: u64, content: &[u8]) {
        let _ = self.try_write(&self.path(kind, key), key, content);
    }

    fn try_write(&self, path: &Path, key: u64, content: &[u8]) -> std::io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
        file.write_all(MAGIC)?;
        file.write_all(&key.to_le_bytes())?;
        file.write_all(&hash(&[content]).to_le_bytes())?;
        file.write_all(content)?;
        file.persist(path)?;
        Ok(())
    }

    fn path(&self, kind: &str, key: u64) -> PathBuf {
        self.folder.join(format!("{kind}-{key:016x}"))
    }
}

/// When the running program was built, ns: what it makes may be made otherwise by another. 0 where nobody knows.
pub fn program() -> u64 {
    let file = std::env::current_exe().and_then(|exe| exe.metadata()).ok();
    let built = file.and_then(|m| m.modified().ok()).and_then(|t| t.duration_since(std::time::UNIX_EPOCH).ok());
    built.map_or(0, |t| t.as_nanos() as u64)
}

/// 64 bits of some runs of bytes, eight at a time: FNV-1a's step (Fowler, Noll & Vo 1991) over words, and its lengths. It tells
/// what differs by chance, not what somebody made to look alike.
pub fn hash(runs: &[&[u8]]) -> u64 {
    let step = |h: u64, word: u64| (h ^ word).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23);
    runs.iter().fold(0xcbf2_9ce4_8422_2325, |h, run| {
        let words = run.chunks(8).map(|c| {
            let mut word = [0; 8];
            word[..c.len()].copy_from_slice(c);
            u64::from_le_bytes(word)
        });
        step(words.fold(h, step), run.len() as u64)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_damaged_is_not_there_and_is_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::in_folder(folder.path().join("made when needed"));
        let content: Vec<u8> = (0..1000u32).map(|i| (i * 7) as u8).collect();
        assert_eq!(cache.read("thing", 5), None);
        cache.write("thing", 5, &content);
        assert_eq!(cache.read("thing", 5).as_ref(), Some(&content));
        assert_eq!(cache.read("thing", 6), None, "another key");
        assert_eq!(cache.read("other", 5), None, "another kind");
        let path = cache.path("thing", 5);
        let whole = fs::read(&path).expect("written");
        let damages: [(&str, Vec<u8>); 5] = [
            ("empty", Vec::new()),
            ("cut off", whole[..whole.len() - 1].to_vec()),
            ("cut off in its head", whole[..20].to_vec()),
            ("a bit over", {
                let mut b = whole.clone();
                b[500] ^= 1;
                b
            }),
            ("somebody else's", b"not ours at all, and long enough to be read".to_vec()),
        ];
        for (what, bytes) in damages {
            fs::write(&path, bytes).expect("writable");
            assert_eq!(cache.read("thing", 5), None, "{what}");
            cache.write("thing", 5, &content);
            assert_eq!(cache.read("thing", 5).as_ref(), Some(&content), "after {what}");
        }
        assert_eq!(fs::read_dir(&cache.folder).expect("there").count(), 1, "no temporary file stays");
        // A file under another key's name.
        fs::copy(&path, cache.path("thing", 9)).expect("copied");
        assert_eq!(cache.read("thing", 9), None);
    }

    #[test]
    fn a_hash_tells_runs_apart() {
        let of = |runs: &[&[u8]]| hash(runs);
        assert_ne!(of(&[b"ab", b"c"]), of(&[b"a", b"bc"]));
        assert_ne!(of(&[b"a\0"]), of(&[b"a"]));
        assert_eq!(of(&[b"abc"]), of(&[b"abc"]));
    }
}
