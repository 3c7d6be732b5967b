//! Line numbers of all syntax elements.

use super::{body, unit, value};
use crate::syntax::{Expression, ExpressionKind, Member, StatementKind};

#[test]
fn of_classes_and_members() {
    let text = "/** What it is. */\n@Tag\npublic\nclass \
        A\n{\n  // a\n  @Inject\n  int b,\n  c;\n  static\n  void\n  d() { }\n  \
                A\n  () { }\n enum\n E {\n F,\n G { } } }";
    for text in [text.to_owned(), text.replace('\n', "\r\n")] {
        let class = &unit(&text).classes[0];
        assert_eq!(class.line, 4);
        let fields = class.members.iter().map(|member| match member {
            Member::Field(field) => field.line,
            Member::Initializer { .. } => 0,
        });
        assert_eq!(fields.collect::<Vec<_>>(), [8, 9]);
        assert_eq!(class.methods[0].line, 12);
        assert_eq!(class.constructors[0].line, 13);
        assert_eq!(class.classes[0].line, 16);
        let constants = class.classes[0].constants.iter();
        assert_eq!(constants.map(|constant| constant.line).collect::<Vec<_>>(), [17, 18]);
    }
}

#[test]
fn of_statements() {
    let text = "// first\n/* then */ a();\n@Tag\nfinal int\nb = 1;\nlabel:\nfor (;;)\nbreak;\nif \
        (a)\n;\nelse\nreturn;\n\
        try\n{ } finally {\n}\nswitch (a) { case 1:\nc(); }\nclass D { }\ndo\n; while (a);\nthrow \
        a;\n(a)\n.b();\n\
        synchronized (a) { }\nwhile (a) ;\n{ }\nassert a;";
    // The first line of the method body is 2.
    let lines: Vec<u32> = body(text).iter().map(|statement| statement.line - 1).collect();
    assert_eq!(lines, [2, 3, 6, 9, 13, 16, 18, 19, 21, 22, 24, 25, 26, 27]);
    let StatementKind::Labelled { body, .. } = &body(text)[2].kind else { panic!("no label") };
    assert_eq!(body.line - 1, 7);
}

#[test]
fn of_calls_and_fields_are_those_of_their_names() {
    let call = value("robot\n.getTool()\n  .frame\n.\nmove(\nptp(1)\n.setVelocity(2)\n)");
    assert_eq!(call.line, 5);
    let ExpressionKind::Call { on: Some(frame), arguments, .. } = call.kind else {
        panic!("no call")
    };
    assert_eq!((frame.line, arguments[0].line), (3, 7));
    let ExpressionKind::Field { object: tool, .. } = frame.kind else { panic!("no field") };
    assert_eq!(tool.line, 2);
    let ExpressionKind::Call { on: Some(robot), .. } = tool.kind else { panic!("no call") };
    assert_eq!(robot.line, 1);
}

#[test]
fn of_other_expressions_are_those_where_they_begin() {
    let line = |written: &str| value(written).line;
    assert_eq!(line("\n1"), 2);
    assert_eq!(line("a\n.b() +\nc"), 1);
    assert_eq!(line("\na\n.b[1]"), 2);
    assert_eq!(line("\n-\n1"), 2);
    assert_eq!(line("\n(\nint) a"), 2);
    assert_eq!(line("\n(a\n.b) ? c\n: d"), 2);
    assert_eq!(line("\nnew\nA\n()"), 2);
    assert_eq!(line("\na\n= 3"), 2);
    assert_eq!(line("\n/* ( */ (a)\n+ b"), 2);
    assert_eq!(line("\na\n++"), 2);
    assert_eq!(line("\nx ->\nx"), 2);
    let Expression { kind: ExpressionKind::Binary { right, .. }, .. } =
        value("a +\n// b\n(c) -\nd")
    else {
        panic!("no difference")
    };
    assert_eq!(right.line, 4);
}
