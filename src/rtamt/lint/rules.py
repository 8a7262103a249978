"""The table of rules, the source of the findings, the command-line help and the manual page of each code."""

from __future__ import annotations

from rtamt.lint import comparisons, ranges, structure, text_rules
from rtamt.lint.found import Rule

RULES: tuple[Rule, ...] = (
    Rule(
        "RT101",
        "a number where a formula is expected",
        "A number in the place of a formula is its own robustness: it holds where it is positive. That is seldom "
        "what is meant, and it mixes the unit of the number with the margins of comparisons.",
        "x and y >= 3",
        "x > 0 and y >= 3",
        text_rules.number_as_formula,
    ),
    Rule(
        "RT102",
        "a formula where a number is expected",
        "In arithmetic a formula is its robustness. To count where it holds, use `duration`, `count` or `if`.",
        "(x >= 3) + 1 > 2",
        "(if x >= 3 then 1 else 0) + y > 2",
        text_rules.formula_as_number,
    ),
    Rule(
        "RT103",
        "a comparison of constants",
        "A comparison without a variable always holds or never does.",
        "3 >= 2 and x >= 1",
        "x >= 2 and x <= 3",
        text_rules.constant_comparison,
    ),
    Rule(
        "RT104",
        "a division by the constant 0",
        "The quotient is infinite or undefined at every instant.",
        "x / 0 >= 1",
        "x / 2 >= 1",
        text_rules.division_by_zero,
    ),
    Rule(
        "RT105",
        "a prefix operator directly before a parenthesis, whose operand extends past it",
        "`prev(x) - x <= 3` looks like a function of `x`, but prefix operators bind more weakly than arithmetic and "
        "comparisons: the operand is all of `(x) - x <= 3`.",
        "prev(x) - x <= 3",
        "delay(x) - x <= 3",
        text_rules.past_parenthesis,
    ),
    Rule(
        "RT106",
        "a value that is held for less than the sampling period",
        "A signal that is recorded once a period is then missing at some instants.",
        "sample 100ms hold for 50ms  x >= 3",
        "sample 100ms hold for 1s  x >= 3",
        text_rules.held_too_short,
    ),
    Rule(
        "RT107",
        "a bound that is shorter than the sampling period",
        "No sample lies between the present one and the bound. The period is that of the text (`sample 100ms`), or of "
        "`--period`.",
        "sample 100ms  always[0:50ms](x >= 3)",
        "sample 100ms  always[0:200ms](x >= 3)",
        text_rules.shorter_than_a_period,
        "error",
    ),
    Rule(
        "RT201",
        "a number that has a name and is never used",
        "A named number that no formula reads has no effect. Often `=` was written instead of `==`.",
        "sum = x + y; x >= 3",
        "sum = x + y; sum >= 3",
        text_rules.unused_number,
    ),
    Rule(
        "RT202",
        "a formula that is no requirement, because the text uses 'require'",
        "In a text with `require`, only those formulas are checked.",
        "require R1: x >= 3; y >= 2",
        "require R1: x >= 3; require R2: y >= 2",
        text_rules.not_required,
    ),
    Rule(
        "RT203",
        "a constant, parameter, table or enumeration that is never used",
        "It may be left over, or a formula contains the number instead of the name.",
        "const float limit = 3; float x; x <= 4",
        "const float limit = 3; float x; x <= limit",
        text_rules.unused_declaration,
    ),
    Rule(
        "RT301",
        "different quantities in a sum or comparison, or in a function of angles or plain numbers",
        "The sum of a speed and a distance has no meaning.",
        "input float speed [m/s]  input float gap [m]  speed + gap > 3",
        "input float speed [m/s]  input float gap [m]  const float ahead = 2 [s]  speed * ahead + gap > 3",
        text_rules.different_quantities,
        "error",
    ),
    Rule(
        "RT302",
        "the same quantity in different units, such as degrees and radians",
        "Formulas compute with numbers; they do not convert units.",
        "input float heading [deg]  sin(heading) > 0",
        "input float heading [deg]  sin(radians(heading)) > 0",
        text_rules.different_units,
        "error",
    ),
    Rule(
        "RT303",
        "units that cannot be checked",
        "A unit is unknown, so the formulas that use it are not checked.",
        "input float v [kmh]  parameter float limit = 30 [m/s]  v < limit",
        "input float v [km/h]  parameter float limit = 30 [km/h]  v < limit",
        text_rules.unchecked_units,
        "note",
    ),
    Rule(
        "RT401",
        "a formula that always holds within the declared ranges",
        "No recording within the declared ranges of the variables violates it: a limit may be wrong, or the comparison "
        "reversed. The bounds of the formula are computed from the ranges, so a formula that reads one variable twice "
        "may always hold without this warning.",
        "input float speed in [0, 60]  always(speed <= 100)",
        "input float speed in [0, 60]  always(speed <= 50)",
        ranges.always_holds,
    ),
    Rule(
        "RT402",
        "a formula that never holds within the declared ranges",
        "Every recording within the declared ranges of the variables violates it: a limit or a unit may be wrong.",
        "input float speed in [0, 60]  output float brake  always(speed > 100 or brake > 0.5)",
        "input float speed in [0, 60]  output float brake  always(speed > 50 or brake > 0.5)",
        ranges.never_holds,
    ),
    Rule(
        "RT403",
        "an implication that is never triggered within the declared ranges",
        "The implication holds on every recording, whatever follows from it.",
        "input float speed in [0, 60]  output float brake  always(speed > 100 -> brake > 0.5)",
        "input float speed in [0, 60]  output float brake  always(speed > 50 -> brake > 0.5)",
        ranges.never_triggered,
    ),
    Rule(
        "RT404",
        "a branch of 'if' that is never reached within the declared ranges",
        "The condition always holds or never does, so that one branch has no effect.",
        "input float speed in [0, 60]  output float gap  gap > (if speed > 100 then 50 else 20)",
        "input float speed in [0, 60]  output float gap  gap > (if speed > 50 then 50 else 20)",
        ranges.branch_never_taken,
    ),
    Rule(
        "RT405",
        "comparisons of one number that contradict each other",
        "A conjunction of comparisons with constants that no number satisfies: limits are exchanged, or `and` was "
        "written instead of `or`.",
        "always(x > 5 and y > 0 and x < 3)",
        "always(x > 3 and y > 0 and x < 5)",
        comparisons.contradiction,
    ),
    Rule(
        "RT406",
        "comparisons of one number of which one always holds",
        "A disjunction of comparisons with constants that every number satisfies: limits are exchanged, or `or` was "
        "written instead of `and`.",
        "enum Mode { MANUAL, AUTO, RTL }  input Mode mode  always(mode != AUTO or mode != RTL)",
        "enum Mode { MANUAL, AUTO, RTL }  input Mode mode  always(mode != AUTO and mode != RTL)",
        comparisons.tautology,
    ),
    Rule(
        "RT407",
        "a comparison that changes nothing beside a tighter one",
        "Of several limits of a number in one direction a conjunction needs the tightest only, and a disjunction the "
        "loosest.",
        "always(speed <= 50 and gap >= 2 and speed <= 30)",
        "always(gap >= 2 and speed <= 30)",
        comparisons.weaker_comparison,
    ),
    Rule(
        "RT408",
        "a branch of 'if' behind a condition that was tested before",
        "The branch of the first test was taken wherever the condition holds, so the second test never succeeds.",
        "enum Mode { MANUAL, AUTO, RTL }  input Mode mode  float speed\n"
        "speed <= (if mode == AUTO then 20 else if mode == AUTO then 10 else 5)",
        "enum Mode { MANUAL, AUTO, RTL }  input Mode mode  float speed\n"
        "speed <= (if mode == AUTO then 20 else if mode == RTL then 10 else 5)",
        comparisons.branch_tested_before,
    ),
    Rule(
        "RT501",
        "an operand that is repeated",
        "A part is an operand of the same operator twice, often because a name was copied and not changed.",
        "always(left > 0 and left > 0)",
        "always(left > 0 and right > 0)",
        structure.repeated_operand,
    ),
    Rule(
        "RT502",
        "a requirement that is repeated under another name",
        "Two requirements have the same formula, often because one was copied and not changed.",
        "require R1: always(x >= 3); require R2: always(x >= 3)",
        "require R1: always(x >= 3); require R2: always(y >= 3)",
        structure.repeated_requirement,
    ),
    Rule(
        "RT503",
        "a double negation",
        "`not not` and a double minus have no effect.",
        "always(not not (x > 3))",
        "always(not (x > 3))",
        structure.undone_twice,
    ),
    Rule(
        "RT504",
        "a window of a window of the same operator",
        "`eventually[0:2] eventually[0:3]` is one window, `eventually[0:5]`. Often one of the two was meant to be "
        "`always`.",
        "eventually[0:2] eventually[0:3](x > 3)",
        "eventually[0:2] always[0:3](x > 3)",
        structure.same_window_twice,
    ),
    Rule(
        "RT505",
        "'always eventually' or 'eventually always' without bounds",
        "On a recording, which ends, both depend on the last sample only: nothing comes after it. Bound the inner "
        "operator.",
        "always eventually (x > 3)",
        "always eventually[0:5](x > 3)",
        structure.last_sample_only,
    ),
    Rule(
        "RT506",
        "'always' and 'eventually' inside each other with the same bounds",
        "The windows add up: `always[0:5] eventually[0:5]` reads 10 seconds ahead. Often one window was meant.",
        "always[0:5] eventually[0:5](x > 3)",
        "always[0:60] eventually[0:5](x > 3)",
        structure.same_bounds,
    ),
    Rule(
        "RT507",
        "true or false as an operand that simplifies the formula",
        "`true until p` is `eventually p`, `p and true` is `p`, `p -> false` is `not p`.",
        "true until[0:5] (x > 3)",
        "eventually[0:5](x > 3)",
        structure.constant_operand,
    ),
    Rule(
        "RT508",
        "'always' or 'historically' that ends before an implication",
        "`always p -> q` is `(always p) -> q`, which is satisfied as soon as `p` fails once. To require `q` wherever "
        "`p` holds, write `always(p -> q)`.",
        "always x > 3 -> y > 2",
        "always(x > 3 -> y > 2)",
        structure.whole_implication,
    ),
    Rule(
        "RT509",
        "a window of one instant",
        "`always[0:0]` and `eventually[0:0]` are their operand.",
        "always[0:0](x > 3)",
        "always[0:1](x > 3)",
        structure.one_instant,
    ),
)

#: The code of a comment that silences nothing.
UNUSED_COMMENT = Rule(
    "RT001",
    "a comment that silences a warning that is not there",
    "`// lint: ignore[CODE]` silences a code on its line; alone on a line, on the next one. One that silences nothing "
    "is left over, or has a wrong code.",
    "x >= 3 // lint: ignore[RT105]",
    "prev(x) - x <= 3 // lint: ignore[RT105]",
    lambda _text: (),
)
ALL = (UNUSED_COMMENT, *RULES)
#: The codes of findings that depend on more than the text: on the period, and on files that import it.
SHORTER, UNUSED = "RT107", "RT203"
CODES = tuple(rule.code for rule in ALL)
