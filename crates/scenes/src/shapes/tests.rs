//! Tests of texts and pictures as shapes.

use super::*;
