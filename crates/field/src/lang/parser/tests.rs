use super::super::ast::{Assignment, Ast, BinaryOp, Expr, ExprId, Item, Loop, Statement, Statements, When};
use super::super::diagnostic::Diagnostics;
use super::super::lexer::tokenize;
use super::super::library::library;
use super::super::symbol::{Interner, Symbol};
use super::parse;

/// Returns the items of a text, with expressions in prefix form, and the messages about it.
fn parsed(text: &str) -> (Vec<String>, Vec<String>) {
    let mut names = library().names.clone();
    let (mut tokens, mut diagnostics, mut ast) = (Vec::new(), Diagnostics::new(20), Ast::default());
    tokenize(text, 0, 10_000, &mut names, &mut tokens, &mut diagnostics);
    let items = parse(&tokens, &names, 64, &mut ast, &mut diagnostics);
    let show = |id| shown(&ast, &names, id);
    let items = items.iter().map(|item| match item {
        Item::Bare(value) => show(*value),
        Item::Let { name, value } => format!("let {} {}", names.name(name.symbol), show(*value)),
        Item::Fn(function) => format!("fn {} {}", names.name(function.name.symbol), show(function.body)),
        Item::Param { name, value, range } => {
            let range = range.map_or(String::new(), |(a, b)| format!(" in {} .. {}", show(a), show(b)));
            format!("param {} {}{range}", names.name(name.symbol), show(*value))
        }
        Item::Section { section, name, entries, .. } => {
            let entries: Vec<String> = entries
                .iter()
                .map(|one| format!("{} {}", names.name(one.name.symbol), show(one.value)))
                .collect();
            format!("{section:?} {} {}", name.map_or("", |name| names.name(name.symbol)), entries.join("; "))
        }
        Item::Include { path } => format!("include {}", names.name(path.symbol)),
        Item::Broken(name) => format!("broken {}", names.name(name.symbol)),
    });
    (items.collect(), diagnostics.finish().into_iter().map(|one| one.message).collect())
}

fn shown(ast: &Ast, names: &Interner, id: ExprId) -> String {
    let show = |id: ExprId| shown(ast, names, id);
    let extra = |index: u32| ExprId(ast.extra(index));
    match ast.expr(id) {
        Expr::Error => "?".to_owned(),
        Expr::Number(value) => value.to_string(),
        Expr::Bool(value) => value.to_string(),
        Expr::Text(symbol) => format!("{:?}", names.name(symbol)),
        Expr::Name(symbol) => names.name(symbol).to_owned(),
        Expr::Negate(a) => format!("(neg {})", show(a)),
        Expr::Not(a) => format!("(not {})", show(a)),
        Expr::Binary(op, a, b) => format!("({} {} {})", op.sign(), show(a), show(b)),
        Expr::Swizzle(a, components) => format!("{}.{}", show(a), names.name(components)),
        Expr::If(a, b, c) => format!("(if {} {} {})", show(a), show(b), show(c)),
        Expr::PartBand(part, index) => format!("{}.band({})", names.name(part), show(index)),
        Expr::Call(name, first, count) => {
            let arguments: Vec<String> = (0..count).map(|index| show(extra(first + index))).collect();
            format!("{}({})", names.name(name), arguments.join(" "))
        }
        Expr::Block(first, count, result) => {
            format!("{{{}{}}}", statements(ast, names, Statements { first, count }), show(result))
        }
        Expr::Record(first, count) => {
            let fields = (0..count).map(|index| {
                let at = first + 2 * index;
                format!(" {}={}", names.name(Symbol(ast.extra(at))), show(extra(at + 1)))
            });
            format!("(record{})", fields.collect::<String>())
        }
        Expr::Let(name, value) => format!("{}={}", names.name(name), show(value)),
        Expr::Statement(index) => match ast.statement(index).unwrap() {
            Statement::Assign(Assignment { name, components, op, value }) => {
                let components = components.map_or(String::new(), |one| format!(".{}", names.name(one)));
                let op = op.map_or("", BinaryOp::sign);
                format!("{}{components}<{op}-{}", names.name(name), show(value))
            }
            Statement::Loop(Loop { variable, first, end, condition, body }) => {
                let condition = condition.map_or(String::new(), |one| format!(" while {}", show(one)));
                let body = statements(ast, names, body);
                format!("[{} {} {}{condition}: {body}]", names.name(variable), show(first), show(end))
            }
            Statement::When(When { condition, yes, no }) => {
                let [yes, no] = [yes, no].map(|side| statements(ast, names, side));
                format!("[{}? {yes}: {no}]", show(condition))
            }
        },
        Expr::Break => "break".to_owned(),
        Expr::For(at) => {
            let name = names.name(Symbol(ast.extra(at)));
            format!("(for {name} {} {} {})", show(extra(at + 1)), show(extra(at + 2)), show(extra(at + 3)))
        }
    }
}

fn statements(ast: &Ast, names: &Interner, Statements { first, count }: Statements) -> String {
    (0..count).map(|index| shown(ast, names, ExprId(ast.extra(first + index))) + " ").collect()
}

fn items(text: &str) -> Vec<String> {
    let (items, messages) = parsed(text);
    assert_eq!(messages, Vec::<String>::new(), "{text}");
    items
}

#[test]
fn operators_bind_as_in_glsl_and_mathematics() {
    for (text, tree) in [
        ("a + b * c", "(+ a (* b c))"),
        ("a - b - c", "(- (- a b) c)"),
        ("a / b * c", "(* (/ a b) c)"),
        ("a % b + c", "(+ (% a b) c)"),
        ("-a ^ 2", "(neg (^ a 2))"),
        ("2 ^ -a ^ b", "(^ 2 (neg (^ a b)))"),
        ("a ^ b ^ c", "(^ a (^ b c))"),
        ("-a * b", "(* (neg a) b)"),
        ("a * -b.x", "(* a (neg b.x))"),
        ("- - a", "(neg (neg a))"),
        ("a < b && c >= d || !e", "(|| (&& (< a b) (>= c d)) (not e))"),
        ("a == b + 1", "(== a (+ b 1))"),
        ("(a + b).xy.x", "(+ a b).xy.x"),
        ("if a then b else c + 1", "(if a b (+ c 1))"),
        ("1 + if a then b else if c then d else e", "(+ 1 (if a b (if c d e)))"),
        ("union(for i in 0..32: f(i), a)", "union((for i 0 32 f(i)) a)"),
        ("f(a, b,)", "f(a b)"),
    ] {
        assert_eq!(parsed(text).0[0], tree, "{text}");
    }
}

#[test]
fn line_ends_separate_ambiguous_lines() {
    assert_eq!(items("let a = 1\n- b"), ["let a (- 1 b)"]);
    assert_eq!(items("let a = 1\n-b"), ["let a 1", "(neg b)"]);
    assert_eq!(items("let a = 1\n + b"), ["let a (+ 1 b)"]);
    assert_eq!(items("let a = b\n(c)"), ["let a b", "c"]);
    assert_eq!(items("let a = 1; let b = 2 let c = 3"), ["let a 1", "let b 2", "let c 3"]);
    assert_eq!(items("fn f(p) {\n let d = length(p)\n -d\n}"), ["fn f {d=length(p) (neg d)}"]);
}

#[test]
fn statements_are_read_with_and_without_semicolons() {
    for (text, tree) in [
        ("{ let z = p  z = z * z; z.xy += 1  z /= 2\n z }", "{z=p z<-(* z z) z.xy<+-1 z</-2 z}"),
        ("{ for i in 0..8 while a < 2 { a = f(a) b -= i } a }", "{[i 0 8 while (< a 2): a<-f(a) b<--i ] a}"),
        (
            "{ if a > 0 { a = 1 } else if b > 0 { b = 1 } else { c = 1 } a }",
            "{[(> a 0)? a<-1 : [(> b 0)? b<-1 : c<-1 ] ] a}",
        ),
        ("{ for i in 0..9 { if (a > 4) break; a *= a } a }", "{[i 0 9: [(> a 4)? break : ] a<*-a ] a}"),
        ("{ if a > 0 then 1 else 2 }", "{(if (> a 0) 1 2)}"),
        ("{ if (a > 0) a = 1; else a = 2; a }", "{[(> a 0)? a<-1 : a<-2 ] a}"),
        ("{ let r = a\n -r }", "{r=a (neg r)}"),
        ("(near = a, index = b + 1).near", "(record near=a index=(+ b 1)).near"),
        ("{ }\nx", "{?}"),
    ] {
        assert_eq!(parsed(text).0[0], tree, "{text}");
    }
}

#[test]
fn every_item_is_read() {
    let text = "\u{feff}param melt = 1.3 in 0.1 .. 3 # slider\r\nfn f(a, b: vec3) = a\r\ninclude \"x.scene\"\r\n\
                material wood { color = vec3(1)  roughness = 0.6 }\nobject o { let q = p; shape = f(q, 1) material = wood }\n\
                camera { position = vec3(0) } sky { color = 1 } light l { position = 2 }";
    assert_eq!(
        items(text),
        [
            "param melt 1.3 in 0.1 .. 3",
            "fn f a",
            "include x.scene",
            "Material wood color vec3(1); roughness 0.6",
            "Object o q p; shape f(q 1); material wood",
            "Camera  position vec3(0)",
            "Sky  color 1",
            "Light l position 2",
        ]
    );
}

#[test]
fn parsing_continues_after_a_mistake() {
    let text = "let a = (1 + \nlet b = 2 *\nfn f(p) { while c { c = 1 }  c }\nobject o { shape = sphere(p, 1  material = wood }\n\
                object q { shape = p.y, material = )stone }\nlet z = 26";
    let (items, messages) = parsed(text);
    assert_eq!(messages.len(), 6, "{messages:#?}");
    assert!(items.contains(&"let z 26".to_owned()), "{items:#?}");
    assert!(items.iter().any(|item| item.starts_with("fn f")), "{items:#?}");
    assert!(items.iter().any(|item| item.starts_with("Object q shape p.y; material")), "{items:#?}");
}
