//! The functions of GLSL for the second interpreter, as the specification of GLSL defines them.

use naga::MathFunction as Of;

use super::witness::{Value, each, floats};

fn vector(parts: impl IntoIterator<Item = f32>) -> Value {
    Value::List(parts.into_iter().map(Value::Float).collect())
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn columns(value: &Value) -> Vec<Vec<f64>> {
    match value {
        Value::List(list) => {
            list.iter().map(|column| floats(column).into_iter().map(f64::from).collect()).collect()
        }
        other => panic!("no matrix: {other:?}"),
    }
}

/// Determinant and inverse by elimination with pivots.
fn eliminated(mut m: Vec<Vec<f64>>) -> (f64, Vec<Vec<f64>>) {
    let n = m.len();
    let mut inverse: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    let mut determinant = 1.0;
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs())).unwrap();
        if pivot != i {
            m.swap(pivot, i);
            inverse.swap(pivot, i);
            determinant = -determinant;
        }
        let lead = m[i][i];
        determinant *= lead;
        for k in 0..n {
            m[i][k] /= lead;
            inverse[i][k] /= lead;
        }
        for row in (0..n).filter(|&row| row != i) {
            let factor = m[row][i];
            for k in 0..n {
                m[row][k] -= factor * m[i][k];
                inverse[row][k] -= factor * inverse[i][k];
            }
        }
    }
    (determinant, inverse)
}

fn matrix(columns: &[Vec<f64>]) -> Value {
    Value::List(columns.iter().map(|column| vector(column.iter().map(|&x| x as f32))).collect())
}

fn of_vectors(of: Of, a: &Value, b: Option<&Value>, c: Option<&Value>) -> Option<Value> {
    let (x, y) = (floats(a), b.map(floats).unwrap_or_default());
    Some(match of {
        Of::Dot => Value::Float(dot(&x, &y)),
        Of::Length => Value::Float(dot(&x, &x).sqrt()),
        Of::Distance => Value::Float(x.iter().zip(&y).map(|(a, b)| (a - b) * (a - b)).sum::<f32>().sqrt()),
        Of::Normalize => {
            let length = dot(&x, &x).sqrt();
            vector(x.iter().map(|a| a / length))
        }
        Of::Cross => {
            vector([x[1] * y[2] - y[1] * x[2], x[2] * y[0] - y[2] * x[0], x[0] * y[1] - y[0] * x[1]])
        }
        Of::Reflect => {
            let along = 2.0 * dot(&x, &y);
            vector(x.iter().zip(&y).map(|(i, n)| i - along * n))
        }
        Of::Refract => {
            let (eta, along) = (floats(c.unwrap())[0], dot(&x, &y));
            let k = 1.0 - eta * eta * (1.0 - along * along);
            vector(x.iter().zip(&y).map(
                |(i, n)| {
                    if k < 0.0 { 0.0 } else { eta * i - (eta * along + k.sqrt()) * n }
                },
            ))
        }
        Of::FaceForward => {
            let sign = if dot(&floats(c.unwrap()), &y) < 0.0 { 1.0 } else { -1.0 };
            vector(x.iter().map(|n| sign * n))
        }
        Of::Outer => Value::List(y.iter().map(|b| vector(x.iter().map(|a| a * b))).collect()),
        Of::Transpose => {
            let m = columns(a);
            let rows: Vec<Vec<f64>> =
                (0..m[0].len()).map(|row| m.iter().map(|column| column[row]).collect()).collect();
            matrix(&rows)
        }
        Of::Determinant => Value::Float(eliminated(columns(a)).0 as f32),
        Of::Inverse => matrix(&eliminated(columns(a)).1),
        _ => return None,
    })
}

fn of_whole(of: Of, x: i32, b: Option<&Value>, c: Option<&Value>) -> i32 {
    let whole = |value: Option<&Value>| match value {
        Some(Value::Int(value)) => *value,
        other => panic!("no whole number: {other:?}"),
    };
    match of {
        Of::Abs => x.abs(),
        Of::Sign => x.signum(),
        Of::Min => x.min(whole(b)),
        Of::Max => x.max(whole(b)),
        Of::Clamp => x.max(whole(b)).min(whole(c)),
        other => panic!("unexpected {other:?}"),
    }
}

pub(super) fn math(of: Of, a: &Value, b: Option<&Value>, c: Option<&Value>) -> Value {
    if let Some(value) = of_vectors(of, a, b, c) {
        return value;
    }
    match *a {
        Value::Int(x) => Value::Int(of_whole(of, x, b, c)),
        _ => of_one(of, a).unwrap_or_else(|| of_several(of, a, b, c)),
    }
}

fn of_one(of: Of, a: &Value) -> Option<Value> {
    Some(match of {
        Of::Abs => each(of, a, f32::abs),
        Of::Cos => each(of, a, f32::cos),
        Of::Cosh => each(of, a, f32::cosh),
        Of::Sin => each(of, a, f32::sin),
        Of::Sinh => each(of, a, f32::sinh),
        Of::Tan => each(of, a, f32::tan),
        Of::Tanh => each(of, a, f32::tanh),
        Of::Acos => each(of, a, f32::acos),
        Of::Asin => each(of, a, f32::asin),
        Of::Atan => each(of, a, f32::atan),
        Of::Asinh => each(of, a, f32::asinh),
        Of::Acosh => each(of, a, f32::acosh),
        Of::Atanh => each(of, a, f32::atanh),
        Of::Radians => each(of, a, f32::to_radians),
        Of::Degrees => each(of, a, f32::to_degrees),
        Of::Ceil => each(of, a, f32::ceil),
        Of::Floor => each(of, a, f32::floor),
        Of::Round => each(of, a, |x| (x + 0.5).floor()),
        Of::Fract => each(of, a, |x| x - x.floor()),
        Of::Trunc => each(of, a, f32::trunc),
        Of::Exp => each(of, a, f32::exp),
        Of::Exp2 => each(of, a, f32::exp2),
        Of::Log => each(of, a, f32::ln),
        Of::Log2 => each(of, a, f32::log2),
        Of::Sqrt => each(of, a, f32::sqrt),
        Of::InverseSqrt => each(of, a, |x| 1.0 / x.sqrt()),
        Of::Sign => each(of, a, |x| {
            if x > 0.0 {
                1.0
            } else if x < 0.0 {
                -1.0
            } else {
                0.0
            }
        }),
        _ => return None,
    })
}

fn of_several(of: Of, a: &Value, b: Option<&Value>, c: Option<&Value>) -> Value {
    let two = |f: &dyn Fn(f32, f32) -> f32| zip(a, b.unwrap(), f);
    let three = |f: &dyn Fn(f32, f32, f32) -> f32| {
        let pairs = zip(a, b.unwrap(), &|a, _| a);
        let (b, c) = (b.unwrap(), c.unwrap());
        let len = floats(&pairs).len();
        let part = |value: &Value, at: usize| {
            let list = floats(value);
            if list.len() == 1 { list[0] } else { list[at] }
        };
        let parts: Vec<f32> =
            (0..len.max(floats(c).len())).map(|at| f(part(a, at), part(b, at), part(c, at))).collect();
        if let [one] = parts.as_slice() { Value::Float(*one) } else { vector(parts) }
    };
    match of {
        Of::Min => two(&f32::min),
        Of::Max => two(&f32::max),
        Of::Pow => two(&f32::powf),
        Of::Atan2 => two(&f32::atan2),
        Of::Step => two(&|edge, x| if x < edge { 0.0 } else { 1.0 }),
        Of::Clamp => three(&|x, low, high| x.max(low).min(high)),
        Of::Mix => three(&|a, b, t| a * (1.0 - t) + b * t),
        Of::Fma => three(&|a, b, c| a * b + c),
        Of::SmoothStep => three(&|low, high, x| {
            let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
            t * t * (3.0 - 2.0 * t)
        }),
        other => panic!("unexpected {other:?}"),
    }
}

fn zip(a: &Value, b: &Value, f: &dyn Fn(f32, f32) -> f32) -> Value {
    let (x, y) = (floats(a), floats(b));
    let len = x.len().max(y.len());
    let pick = |list: &[f32], at: usize| if list.len() == 1 { list[0] } else { list[at] };
    let parts: Vec<f32> = (0..len).map(|at| f(pick(&x, at), pick(&y, at))).collect();
    if let [one] = parts.as_slice() { Value::Float(*one) } else { vector(parts) }
}
