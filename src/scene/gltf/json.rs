//! A place in the JSON tree that knows its own path, so that every complaint names the property at fault. All of a
//! file's claims are read through it: a wrong type or an index out of range cannot pass unnoticed.

use serde_json::Value;

use crate::scene::error::Fault;

/// A value and where it stands, such as `meshes[2].primitives[0]`.
#[derive(Clone)]
pub(super) struct At<'a> {
    value: &'a Value,
    path: String,
}

impl<'a> At<'a> {
    /// The whole document, which must be an object.
    pub fn root(value: &'a Value) -> Result<Self, Fault> {
        let root = Self { value, path: String::new() };
        if value.is_object() { Ok(root) } else { Err(Fault::new("JSON", "the document must be an object")) }
    }

    /// The path of a property of this value.
    pub fn place(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The path of this value.
    pub fn path(&self) -> &str {
        &self.path
    }

    fn raw(&self, key: &str) -> Result<Option<&'a Value>, Fault> {
        match self.value.as_object() {
            Some(object) => Ok(object.get(key).filter(|v| !v.is_null())),
            None => Err(Fault::new(&self.path, "an object was expected")),
        }
    }

    /// The object under a key.
    pub fn object(&self, key: &str) -> Result<Option<Self>, Fault> {
        match self.raw(key)? {
            Some(value) if value.is_object() => Ok(Some(Self { value, path: self.place(key) })),
            Some(_) => Err(Fault::new(self.place(key), "an object was expected")),
            None => Ok(None),
        }
    }

    /// An extension's object.
    pub fn extension(&self, name: &str) -> Result<Option<Self>, Fault> {
        match self.object("extensions")? {
            Some(extensions) => extensions.object(name),
            None => Ok(None),
        }
    }

    /// The names of this object's properties.
    pub fn keys(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        let keys = self.value.as_object().map(|o| o.keys().map(String::as_str));
        keys.into_iter().flatten()
    }

    /// The values of an array; none if the key is absent.
    pub fn list(&self, key: &str) -> Result<Vec<Self>, Fault> {
        let Some(value) = self.raw(key)? else {
            return Ok(Vec::new());
        };
        let array = value.as_array().ok_or_else(|| Fault::new(self.place(key), "an array was expected"))?;
        let place = self.place(key);
        Ok(array.iter().enumerate().map(|(i, value)| Self { value, path: format!("{place}[{i}]") }).collect())
    }

    /// A text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, Fault> {
        self.typed(key, Value::as_str, "a string was expected")
    }

    /// A truth value; false if absent.
    pub fn flag(&self, key: &str) -> Result<bool, Fault> {
        let value = self.typed(key, Value::as_bool, "true or false was expected")?;
        Ok(value.unwrap_or(false))
    }

    /// A finite number.
    pub fn number(&self, key: &str) -> Result<Option<f64>, Fault> {
        self.typed(key, Value::as_f64, "a number was expected")
    }

    /// A whole number, not negative.
    pub fn uint(&self, key: &str) -> Result<Option<u64>, Fault> {
        self.typed(key, whole, "a whole number, 0 or more, was expected")
    }

    /// Exactly `N` numbers.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, Fault> {
        let read = |v: &'a Value| {
            let numbers: Option<Vec<f64>> = v.as_array()?.iter().map(Value::as_f64).collect();
            <[f64; N]>::try_from(numbers?).ok()
        };
        self.typed(key, read, &format!("{N} numbers were expected"))
    }

    /// As many numbers as there are; none if the key is absent.
    pub fn all_numbers(&self, key: &str) -> Result<Vec<f64>, Fault> {
        let read = |v: &'a Value| v.as_array()?.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
        Ok(self.typed(key, read, "an array of numbers was expected")?.unwrap_or_default())
    }

    /// A reference into an array of `len` things.
    pub fn index(&self, key: &str, len: usize, what: &str) -> Result<Option<usize>, Fault> {
        match self.uint(key)? {
            Some(index) if index >= len as u64 => Err(out_of_range(self.place(key), index, len, what)),
            Some(index) => Ok(Some(index as usize)),
            None => Ok(None),
        }
    }

    /// References into an array of `len` things.
    pub fn indices(&self, key: &str, len: usize, what: &str) -> Result<Vec<usize>, Fault> {
        let items = self.list(key)?;
        items
            .iter()
            .map(|item| match whole(item.value) {
                Some(index) if index < len as u64 => Ok(index as usize),
                Some(index) => Err(out_of_range(item.path.clone(), index, len, what)),
                None => Err(Fault::new(&item.path, "a whole number, 0 or more, was expected")),
            })
            .collect()
    }

    /// The texts of an array.
    pub fn texts(&self, key: &str) -> Result<Vec<&'a str>, Fault> {
        self.list(key)?
            .iter()
            .map(|item| {
                let text = item.value.as_str();
                text.ok_or_else(|| Fault::new(&item.path, "a string was expected"))
            })
            .collect()
    }

    /// Turns an absent property into a fault.
    pub fn required<T>(&self, value: Option<T>, key: &str) -> Result<T, Fault> {
        value.ok_or_else(|| Fault::new(self.place(key), "missing, and glTF requires it"))
    }

    fn typed<T>(&self, key: &str, read: impl Fn(&'a Value) -> Option<T>, wanted: &str) -> Result<Option<T>, Fault> {
        match self.raw(key)? {
            Some(value) => match read(value) {
                Some(read) => Ok(Some(read)),
                None => Err(Fault::new(self.place(key), format!("{wanted}, not {}", shortened(value)))),
            },
            None => Ok(None),
        }
    }
}

/// A whole number; glTF allows integers to be written as 1.0.
fn whole(value: &Value) -> Option<u64> {
    const EXACT: f64 = 9_007_199_254_740_992.0;
    value.as_u64().or_else(|| {
        let number = value.as_f64()?;
        (number.fract() == 0.0 && (0.0..EXACT).contains(&number)).then_some(number as u64)
    })
}

fn out_of_range(place: String, index: u64, len: usize, what: &str) -> Fault {
    Fault::new(place, format!("{index} is out of range; the file has {len} {what}"))
}

fn shortened(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".to_owned(),
        Value::String(text) => format!("'{}'", text.chars().take(40).collect::<String>()),
        other => other.to_string(),
    }
}
