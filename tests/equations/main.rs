//! The equations of docs/method.md against independent numbers, closed forms and quadrature.

mod citations;
mod fits;
mod media;
mod plane;
mod vectors;
