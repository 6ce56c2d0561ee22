//! Tests of the language and of worlds through the public interface.

#[allow(dead_code, reason = "other tests use more of it")]
mod expression;
mod melts;
