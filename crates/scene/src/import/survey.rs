//! Finds the properties of a file that are not honoured: its JSON is visited along the table of those that are.
//!
//! Skipped values are not built, so that the memory of the visit is that of its findings.

use super::honoured::{DOCUMENT, Fate, Lookup, MATERIALS, look_up};
use crate::unhonoured::cut;
use serde::de::{Deserialize, DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Value;
use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

/// Most bytes of the name of a property; a longer one is cut.
const MAX_KEY_BYTES: usize = 60;

/// Properties of materials that mean something else where they are left out than with their default.
const ROUGHNESS: &str = "pbrMetallicRoughness.roughnessFactor";
const METALLIC: &str = "pbrMetallicRoughness.metallicFactor";

/// Properties that are not honoured, for each element of each list of the file.
#[derive(Default)]
pub(super) struct Survey {
    lists: BTreeMap<&'static str, Vec<Vec<Finding>>>,
    /// Names of all extensions that have an object.
    pub extensions: BTreeSet<String>,
    /// Materials that state a roughness, or that they are metals.
    glossy: BTreeSet<usize>,
}

/// A property that is not honoured.
pub(super) struct Finding {
    /// Path from the element.
    pub path: String,
    /// Fates on opaque and on translucent surfaces; none where the image shows the property.
    pub on: [Option<Fate>; 2],
}

impl Survey {
    /// The findings about an element of a list.
    pub fn of(&self, list: &str, index: usize) -> &[Finding] {
        self.lists.get(list).and_then(|elements| elements.get(index)).map_or(&[], Vec::as_slice)
    }

    /// Whether a material states a roughness, or a metallic factor above 0.
    pub fn is_glossy(&self, material: usize) -> bool {
        self.glossy.contains(&material)
    }

    /// Number of elements of a list.
    pub fn len(&self, list: &str) -> usize {
        self.lists.get(list).map_or(0, Vec::len)
    }
}

impl<'de> Deserialize<'de> for Survey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Survey, D::Error> {
        let mut survey = Survey::default();
        survey.lists.insert(DOCUMENT, vec![Vec::new()]);
        deserializer.deserialize_any(Walk { survey: &mut survey, list: DOCUMENT, path: "" })?;
        Ok(survey)
    }
}

/// Visits the value at a path.
struct Walk<'a> {
    survey: &'a mut Survey,
    list: &'static str,
    path: &'a str,
}

impl Walk<'_> {
    /// Records a property that is not honoured.
    fn record(&mut self, path: String, on: [Option<Fate>; 2]) {
        if let Some(finds) = self.survey.lists.get_mut(self.list).and_then(|elements| elements.last_mut()) {
            finds.push(Finding { path, on });
        }
    }

    /// Reads a property of the table.
    fn property<'de, A: MapAccess<'de>>(&mut self, map: &mut A, path: String, on: [Fate; 2]) -> Result<(), A::Error> {
        let is_factor = self.list == MATERIALS && [ROUGHNESS, METALLIC].contains(&path.as_str());
        let by_value = is_factor || on.iter().any(|fate| matches!(fate, Fate::TakenAs(_) | Fate::Unless(_)));
        let (numbers, is_there) = if by_value {
            let value: Value = map.next_value()?;
            (numbers(&value), !value.is_null())
        } else {
            (Vec::new(), map.next_value::<Option<IgnoredAny>>()?.is_some())
        };
        if is_factor && is_there && (path == ROUGHNESS || numbers.as_slice() != [0.0]) {
            let index = self.survey.len(MATERIALS).saturating_sub(1);
            self.survey.glossy.insert(index);
        }
        let differs = |expected: &[f64]| !numbers.starts_with(expected);
        let named = |fate: Fate| match fate {
            Fate::Shown | Fate::Neutral | Fate::Reported => None,
            Fate::TakenAs(expected) | Fate::Unless(expected) => differs(expected).then_some(fate),
            Fate::Cuts | Fate::No => Some(fate),
        };
        let on = on.map(named);
        if is_there && on.iter().any(Option::is_some) {
            self.record(path, on);
        }
        Ok(())
    }
}

/// A number, or the numbers of a list.
fn numbers(value: &Value) -> Vec<f64> {
    // The import reads them in float32.
    let number = |v: &Value| v.as_f64().map_or(f64::NAN, |x| f64::from(x as f32));
    value.as_array().map_or_else(|| vec![number(value)], |list| list.iter().map(number).collect())
}

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

/// Methods of a visitor that pass over a value.
macro_rules! pass_over {
    ($($visit:ident($value:ty)),+) => {
        $(fn $visit<E: Error>(self, _: $value) -> Result<(), E> {
            Ok(())
        })+
    };
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            if self.path == "extensions" || self.path.ends_with(".extensions") {
                self.survey.extensions.insert(key.clone());
            }
            let path = if self.path.is_empty() { key } else { format!("{}.{key}", self.path) };
            match look_up(self.list, &path) {
                Lookup::List(list) => map.next_value_seed(Elements { survey: self.survey, list })?,
                Lookup::Inside => map.next_value_seed(Walk { survey: self.survey, list: self.list, path: &path })?,
                Lookup::Property(on) => self.property(&mut map, path, on)?,
                Lookup::Unknown => {
                    map.next_value::<IgnoredAny>()?;
                    self.record(cut(&path, self.path.len() + MAX_KEY_BYTES), [Some(Fate::No); 2]);
                }
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let path = format!("{}[]", self.path);
        while list.next_element_seed(Walk { survey: self.survey, list: self.list, path: &path })?.is_some() {}
        Ok(())
    }

    pass_over!(visit_bool(bool), visit_i64(i64), visit_u64(u64), visit_f64(f64), visit_str(&str));

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }
}

/// Visits the elements of a list.
struct Elements<'a> {
    survey: &'a mut Survey,
    list: &'static str,
}

impl<'de> DeserializeSeed<'de> for Elements<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for Elements<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of {}", self.list)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        loop {
            self.survey.lists.entry(self.list).or_default().push(Vec::new());
            if list.next_element_seed(Walk { survey: self.survey, list: self.list, path: "" })?.is_none() {
                break;
            }
        }
        self.survey.lists.entry(self.list).or_default().pop();
        Ok(())
    }
}
