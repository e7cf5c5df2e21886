//! The media of `data/media`, built in by name.

use crate::{medium::Medium, medium_file::MediumError};

macro_rules! media {
    ($($name:literal,)*) => {
        &[$(($name, include_str!(concat!("../../../data/media/", $name, ".json"))),)*]
    };
}

/// Name and file text of every built-in medium, by name.
static MEDIA: &[(&str, &str)] = media![
    "apple",
    "apple_juice",
    "budweiser_beer",
    "cappuccino_powder",
    "chardonnay",
    "chicken1",
    "chicken2",
    "clorox",
    "coke",
    "coors_light_beer",
    "cranberry_juice",
    "cream",
    "espresso",
    "gatorade",
    "grape_juice",
    "head_shoulders_shampoo",
    "ketchup",
    "lemon_tea_powder",
    "lowfat_chocolate_milk",
    "lowfat_milk",
    "lowfat_soy_milk",
    "marble",
    "merlot",
    "mint_mocha_coffee",
    "orange_powder",
    "pacific_ocean_surface_water",
    "pepsi",
    "pink_lemonade_powder",
    "potato",
    "reduced_milk",
    "regular_chocolate_milk",
    "regular_milk",
    "regular_soy_milk",
    "ruby_grapefruit_juice",
    "salt_powder",
    "shampoo",
    "skimmilk",
    "skin1",
    "skin2",
    "spectralon",
    "sprite",
    "strawberry_shampoo",
    "sugar_powder",
    "suisse_mocha_powder",
    "white_grapefruit_juice",
    "white_zinfandel",
    "wholemilk",
];

/// Names of the built-in media, sorted.
pub fn built_in_names() -> impl Iterator<Item = &'static str> {
    MEDIA.iter().map(|(name, _)| *name)
}

/// A built-in medium; the error of an unknown name suggests similar ones.
pub fn built_in(name: &str) -> Result<Medium, MediumError> {
    match MEDIA.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => Medium::from_json(text),
        None => Err(MediumError::Unknown { name: name.to_owned(), hint: hint(name) }),
    }
}

fn hint(name: &str) -> String {
    let plain = |s: &str| s.to_lowercase().replace([' ', '-', '_'], "");
    let wanted = plain(name);
    let near = |known: &&str| wanted.len() > 2 && (plain(known).contains(&wanted) || wanted.contains(&plain(known)));
    let found: Vec<&str> = built_in_names().filter(near).collect();
    if found.is_empty() {
        "names are lower case with underscores".into()
    } else {
        format!("did you mean {}?", found.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_medium_is_valid_and_named_after_its_file() {
        assert_eq!(MEDIA.len(), 47);
        for name in built_in_names() {
            let medium = built_in(name).expect(name);
            assert_eq!(medium.name, name);
            assert!(!medium.source.is_empty());
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_near_ones() {
        let message = built_in("skim milk").expect_err("unknown").to_string();
        assert!(message.contains("skimmilk"), "{message}");
    }
}
