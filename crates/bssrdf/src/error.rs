//! Errors of media.

/// A medium that cannot be used; the message names the field and the way out.
#[derive(Debug, thiserror::Error)]
pub enum MediumError {
    #[error(
        "not a medium: {0}; expected {{\"name\", \"unit\": \"1/mm\" or \"1/m\", \"sigma_a\": [r,g,b], \"sigma_s\": [r,g,b], \"g\", \"eta\", \"source\"}}, or \"unit\": \"mm\" or \"m\" with \"albedo\" and \"mean_free_path\", or with \"color\" and \"radius\""
    )]
    Json(#[from] serde_json::Error),
    #[error("field `{field}`: {value} is {fault}")]
    Field { field: &'static str, value: f64, fault: &'static str },
    #[error("no medium is called `{name}`; {hint}, `gather --list-media` prints all names, or give a FILE.json")]
    Unknown { name: String, hint: String },
}
