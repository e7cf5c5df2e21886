//! The equations of docs/method.md against independent numbers, closed forms and quadrature.

#[path = "equations/citations.rs"]
mod citations;
#[path = "equations/fits.rs"]
mod fits;
#[path = "equations/media.rs"]
mod media;
#[path = "equations/plane.rs"]
mod plane;
#[path = "equations/vectors.rs"]
mod vectors;
