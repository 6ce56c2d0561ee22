//! The language and what is made of it, from the outside.

#[allow(dead_code, reason = "others take more of it")]
mod expression;
mod melts;
mod non_lipschitz_tracing;
