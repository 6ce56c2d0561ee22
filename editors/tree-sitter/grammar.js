// The grammar is simpler than the language in three places. It does not read line ends: a `-` at the start of a line
// always continues the expression before it. A `(` after a blank is never a call. In a range without blanks, the point
// ends a number only at the start of the range: `n - 1..5` needs blanks around `..`.

const { types, sections, changing, prefixBinds, operators } = require('./words.js');

/// Calls and names behind a point bind more strongly than all operators.
const CALL = 1 + Math.max(prefixBinds, ...operators.map(({ binds }) => binds));

/// Expressions between commas; a final comma is allowed.
const list = (rule) => optional(seq(rule, repeat(seq(',', rule)), optional(',')));

module.exports = grammar({
  name: 'mariana',
  word: ($) => $.name,
  // The sign after `z.x` decides whether it is a value or the target of an assignment.
  conflicts: ($) => [[$._expression, $.part]],
  extras: ($) => [/\s/, '\uFEFF', ';', $.comment],
  rules: {
    scene: ($) => repeat($._item),
    _item: ($) => choice($.include, $.param, $.let, $.function, $.section, $._expression),

    include: ($) => seq('include', field('path', $.text)),
    param: ($) => seq('param', field('name', $.name), '=', field('value', $._expression),
      optional(seq('in', $._range))),
    let: ($) => seq('let', field('name', $.name), '=', field('value', $._expression)),
    function: ($) => seq('fn', field('name', $.name), '(', list($.parameter), ')',
      choice(field('body', $.block), seq('=', field('body', $._expression)))),
    parameter: ($) => seq(field('name', $.name), optional(seq(':', field('type', $.type)))),
    type: () => choice(...types),
    section: ($) => seq(field('kind', choice(...sections)), optional(field('name', $.name)),
      '{', repeat(choice($.let, $.field)), '}'),
    field: ($) => seq(field('name', $.name), '=', choice(field('value', $._expression), $._range)),

    _expression: ($) => choice($.number, $.boolean, $.text, $.name, $.call, $.member, $.group, $.record, $.block, $.if, $.for,
      $.unary, $.binary),
    group: ($) => seq('(', $._expression, ')'),
    record: ($) => seq('(', $.entry, repeat(seq(',', $.entry)), optional(','), ')'),
    entry: ($) => seq(field('name', $.name), '=', field('value', $._expression)),

    block: ($) => seq('{', repeat($._statement), optional($._expression), '}'),
    body: ($) => seq('{', repeat($._statement), '}'),
    _statement: ($) => choice($.let, $.assignment, $.loop, $.when, $.break),
    assignment: ($) => seq(field('target', choice($.name, $.part)),
      field('operator', choice('=', ...changing)), field('value', $._expression)),
    part: ($) => seq($.name, '.', field('name', $.name)),
    loop: ($) => seq('for', field('variable', $.name), 'in', $._range,
      optional(seq('while', field('condition', $._expression))), $.body),
    when: ($) => prec.right(seq('if', field('condition', $._expression), $._branch,
      optional(seq('else', $._branch)))),
    _branch: ($) => choice($.body, $._statement),
    break: () => 'break',

    if: ($) => prec.right(seq('if', $._expression, 'then', $._expression, 'else', $._expression)),
    for: ($) => prec.right(seq('for', field('variable', $.name), 'in', $._range, ':', $._expression)),
    call: ($) => prec(CALL, seq(field('function', $.name), token.immediate('('), list($._expression), ')')),
    member: ($) => prec.left(CALL + 1, seq($._expression, '.', field('name', $.name),
      optional(seq(token.immediate('('), $._expression, ')')))),
    unary: ($) => prec(prefixBinds, seq(field('operator', choice('-', '!')), $._expression)),
    binary: ($) => choice(...operators.map(({ sign, binds, fromTheRight }) => {
      const rule = seq(field('left', $._expression), field('operator', sign), field('right', $._expression));
      return fromTheRight ? prec.right(binds, rule) : prec.left(binds, rule);
    })),

    // In `0..8` the point does not belong to the number.
    _range: ($) => choice(seq($._expression, '..', $._expression), seq($.range_start, $._expression)),
    range_start: () => /-?[0-9]+\.\./,
    number: () => /([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?/,
    boolean: () => choice('true', 'false'),
    text: () => /"[^"\n]*"/,
    name: () => /[A-Za-z_][A-Za-z0-9_]*/,
    comment: () => token(choice(/#[^\n]*/, /\/\/[^\n]*/, /\/\*([^*]|\*+[^*\/])*\*+\//)),
  },
});
