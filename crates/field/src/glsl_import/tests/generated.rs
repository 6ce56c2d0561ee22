//! Random functions: the graph against the second interpreter.

use std::fmt::Write;

use super::agreement::compare;

struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end
    }

    fn pick<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
}

/// Writes the body of a function of `vec3 p` with random statements.
struct Writer {
    random: Random,
    text: String,
    functions: usize,
    loops: usize,
}

impl Writer {
    fn number(&mut self, depth: usize) -> String {
        let deep = depth > 2;
        match self.random.below(if deep { 5 } else { 14 }) {
            0 => format!("{:.2}", self.random.below(300) as f32 / 100.0 - 1.5),
            1 => self.random.pick(&["p.x", "p.y", "p.z", "v.x", "v.z"]).to_owned(),
            2 => self.random.pick(&["a", "b", "g"]).to_owned(),
            3 => "w[1]".to_owned(),
            4 => format!("v[{}]", self.random.below(3)),
            5 => {
                let of = self.random.pick(&["sin", "cos", "abs", "fract", "floor", "tanh"]);
                format!("{of}({})", self.number(depth + 1))
            }
            6 => {
                let of = self.random.pick(&["min", "max"]);
                format!("{of}({}, {})", self.number(depth + 1), self.number(depth + 1))
            }
            7 => format!("clamp({}, -1.0, 1.5)", self.number(depth + 1)),
            8 => format!(
                "({} ? {} : {})",
                self.condition(depth + 1),
                self.number(depth + 1),
                self.number(depth + 1)
            ),
            9 => format!("length({})", self.vector(depth + 1)),
            10 => format!("sin(dot({}, {}))", self.vector(depth + 1), self.vector(depth + 1)),
            11 if self.functions > 0 => {
                format!(
                    "clamp(f{}({}), -2.0, 2.0)",
                    self.random.below(self.functions),
                    self.vector(depth + 1)
                )
            }
            12 => format!("({} / (1.5 + abs({})))", self.number(depth + 1), self.number(depth + 1)),
            _ => {
                let sign = self.random.pick(&["+", "-", "*"]);
                format!("({} {sign} {})", self.number(depth + 1), self.number(depth + 1))
            }
        }
    }

    fn vector(&mut self, depth: usize) -> String {
        match self.random.below(if depth > 2 { 3 } else { 8 }) {
            0 => "p".to_owned(),
            1 => "v".to_owned(),
            2 => self.random.pick(&["p.zxy", "v.yyx", "p.yzx"]).to_owned(),
            3 => format!(
                "vec3({}, {}, {})",
                self.number(depth + 1),
                self.number(depth + 1),
                self.number(depth + 1)
            ),
            4 => format!("sin({})", self.vector(depth + 1)),
            5 => format!("(m * {})", self.vector(depth + 1)),
            6 => format!("mix({}, {}, 0.3)", self.vector(depth + 1), self.vector(depth + 1)),
            _ => format!("({} * {})", self.vector(depth + 1), self.number(depth + 1)),
        }
    }

    fn condition(&mut self, depth: usize) -> String {
        match self.random.below(if depth > 2 { 1 } else { 4 }) {
            1 => format!("({} && {})", self.condition(depth + 1), self.condition(depth + 1)),
            2 => format!("!({} || {})", self.condition(depth + 1), self.condition(depth + 1)),
            _ => {
                let sign = self.random.pick(&["<", ">", "<=", ">="]);
                format!("{} {sign} {}", self.number(depth + 1), self.number(depth + 1))
            }
        }
    }

    fn statements(&mut self, depth: usize, in_loop: bool) {
        for _ in 0..2 + self.random.below(3) {
            self.statement(depth, in_loop);
        }
    }

    fn statement(&mut self, depth: usize, in_loop: bool) {
        let choice = self.random.below(if depth > 2 { 7 } else { 13 });
        let line = match choice {
            0 => format!("a = {};", self.number(0)),
            1 => format!("b += sin({});", self.number(0)),
            2 => format!("v = sin({});", self.vector(0)),
            3 => format!("{} = {}.xy;", self.random.pick(&["p.xz", "v.yx", "p.zy"]), "sin(v)"),
            4 => format!("w[{}] = {};", self.random.below(3), self.number(1)),
            5 => format!("w[int(mod(floor({}), 3.0))] *= 0.5;", self.number(1)),
            6 => "turn(p, a); g = clamp(g + 0.1, -1.0, 1.0);".to_owned(),
            7 if in_loop => format!("if ({}) break;", self.condition(0)),
            8 if in_loop => format!("if ({}) continue;", self.condition(0)),
            9 => format!("if ({}) return {};", self.condition(0), self.number(0)),
            10 => {
                let condition = self.condition(0);
                let _ = writeln!(self.text, "if ({condition}) {{");
                self.statements(depth + 1, in_loop);
                self.text.push_str("} else {\n");
                self.statements(depth + 1, in_loop);
                "}".to_owned()
            }
            11 => {
                self.loops += 1;
                let (counter, count) = (format!("i{}", self.loops), 2 + self.random.below(3));
                let _ = writeln!(self.text, "for (int {counter} = 0; {counter} < {count}; {counter}++) {{");
                let _ = writeln!(self.text, "a += 0.1 * float({counter});");
                self.statements(depth + 1, true);
                "}".to_owned()
            }
            _ => {
                let selector = self.number(1);
                let _ = writeln!(self.text, "switch (int(floor({selector}))) {{ case 0:");
                self.statements(depth + 1, false);
                self.text.push_str("case 1: b += 0.5; break; default:\n");
                self.statements(depth + 1, false);
                "}".to_owned()
            }
        };
        self.text.push_str(&line);
        self.text.push('\n');
    }

    fn function(&mut self) {
        let _ = writeln!(self.text, "float f{}(vec3 p) {{", self.functions);
        self.text.push_str(
            "float a = p.x, b = 0.5; vec3 v = p.yzx; float w[3]; w[0] = p.y; w[1] = 0.2; w[2] = a;\n",
        );
        self.text.push_str("mat3 m = mat3(0.6, 0.8, 0.0, -0.8, 0.6, 0.0, 0.0, p.z, 1.0);\n");
        self.statements(0, false);
        self.text.push_str("return a + b + w[0] + w[2] + v.x + p.z;\n}\n");
        self.functions += 1;
    }
}

/// A file of `count` random functions.
pub(super) fn file(seed: u64, count: usize) -> String {
    let text =
        "float g;\nvoid turn(inout vec3 q, float a) { if (q.x > a) { q = q.zxy; return; } q.y -= 0.2; }\n";
    let mut writer = Writer { random: Random(seed), text: text.to_owned(), functions: 0, loops: 0 };
    for _ in 0..count {
        writer.function();
    }
    writer.text
}

#[test]
fn random_functions_have_the_values_of_a_second_interpreter() {
    let mut compared = 0;
    for seed in 0..40 {
        compared += compare(&format!("seed {seed}"), &file(seed, 3), 100);
    }
    assert!(compared >= 120, "{compared}");
}
