//! Lines, headers and records of tables.

use std::io::BufReader;

use serde_json::{Value, json};

use crate::{
    HeaderFault, HeaderSearch, RecordColumn, Records, TableHeader, TextLine, TextLines, UTF_16,
    bytes_without_mark, is_utf16, without_mark,
};

/// Lines with their numbers, and whether they are complete.
fn lines(text: &[u8], capacity: usize) -> Vec<(u64, String, bool)> {
    let mut lines = TextLines::new(BufReader::with_capacity(capacity, text));
    let mut found = Vec::new();
    while let Some(TextLine { number, text, is_complete }) = lines.next_line().unwrap() {
        found.push((number, String::from_utf8(text.to_vec()).unwrap(), is_complete));
    }
    found
}

#[test]
fn lines_end_with_any_line_break() {
    for capacity in [1, 2, 3, 100] {
        let found = lines(b"\xef\xbb\xbfa\r\nb\r\rc\n\xef\xbb\xbfd", capacity);
        let expected = [
            (1, "a", true),
            (2, "b", true),
            (3, "", true),
            (4, "c", true),
            (5, "\u{feff}d", false),
        ];
        assert_eq!(found, expected.map(|(line, text, whole)| (line, text.to_owned(), whole)));
        assert!(lines(b"", capacity).is_empty());
        assert!(lines(b"\xef\xbb\xbf", capacity).is_empty());
    }
}

#[test]
fn byte_order_marks() {
    assert_eq!((without_mark("\u{feff}a"), without_mark("a\u{feff}")), ("a", "a\u{feff}"));
    assert_eq!(bytes_without_mark(b"\xef\xbb\xbf\xe4"), b"\xe4");
    assert_eq!(bytes_without_mark(b"\xe4"), b"\xe4");
    for (text, expected) in [
        (&b"\xff\xfea\0"[..], true),
        (b"\xfe\xff\0a", true),
        (b"\xef\xbb\xbfa", false),
        (b"", false),
    ] {
        assert_eq!(is_utf16(text), expected, "{text:?}");
    }
}

/// Header of a table whose first column is `x`.
fn header(text: &str) -> Result<Option<TableHeader>, HeaderFault> {
    let mut search = HeaderSearch::default();
    let mut lines = TextLines::new(text.as_bytes());
    while let Some(line) = lines.next_line().unwrap() {
        let found = search.examine(&line, |names| names[0] == "x")?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

#[test]
fn a_header_is_the_first_row_or_a_comment() {
    for (text, line, delimiter, names) in [
        ("\n sep=;\n\tx;y;\n", 3, b';', &["x", "y"][..]),
        ("# by hand\n  % x,\"y, z\"\n", 2, b',', &["x", "y, z"]),
        ("#\n%\n#a b\n#\n1 2\n", 3, b' ', &["a", "b"]),
        ("# note\na  b \n", 2, b' ', &["a", "b"]),
        ("\ta\tb\n", 1, b'\t', &["", "a", "b"]),
        ("a,b\t\n", 1, b',', &["a", "b"]),
    ] {
        let found = header(text).unwrap().unwrap();
        let found_names: Vec<&str> = found.names.iter().map(String::as_str).collect();
        assert_eq!(
            (found.line, found.delimiter, &*found_names),
            (line, delimiter, names),
            "{text}"
        );
    }
    assert_eq!(header("# only\n\n#\n"), Ok(None));
    assert_eq!(header("#\n1,2\n"), Err(HeaderFault::Numbers));
    let quotes = HeaderFault::Quotes("a quote is not closed".to_owned());
    assert_eq!(header("a,\"b\n"), Err(quotes));
}

/// Line number and record, or the fault of the line; or the fault of the table.
type FoundRecord = Result<(u64, Result<Value, String>), String>;

/// Records of a table of numbers, with a text in the column `note`.
fn records(text: &[u8]) -> Vec<FoundRecord> {
    let choose = |names: &[String]| {
        let columns = names.iter().map(|name| {
            let key = name.to_ascii_lowercase();
            let is_text = key == "note";
            let is_known = is_text || ["x", "y"].contains(&&*key);
            is_known.then_some(Some(RecordColumn { key, is_text }))
        });
        let columns: Option<Vec<_>> = columns.collect();
        columns.ok_or_else(|| "unknown column".to_owned())
    };
    let records = Records::new(text, choose).map(|record| match record {
        Ok((line, record)) => Ok((line, record.map(Value::Object))),
        Err(error) => Err(error.to_string()),
    });
    records.collect()
}

#[test]
fn comments_are_skipped_before_and_between_records() {
    for text in [
        "#\nx,y\n1,2\n",
        "%\nx,y\n1,2\n",
        "  # by hand\nx,y\n1,2\n",
        "\t% x y\n# by hand\n1 2\n",
        "x,y\n  # note\n1,2\n",
        "x,y\n%\n1,2",
    ] {
        assert_eq!(records(text.as_bytes()), [Ok((3, Ok(json!({"x": 1, "y": 2}))))], "{text}");
    }
    let both = records(b"\xef\xbb\xbf{\"x\": 1}\nx;note\n2;\"a;b\"\n");
    assert_eq!(both, [Ok((1, Ok(json!({"x": 1})))), Ok((3, Ok(json!({"x": 2, "note": "a;b"}))))]);
}

#[test]
fn a_table_without_names_ends_the_reading() {
    let numbers = "the first line has to name the columns";
    for (text, expected) in [
        (&b"1,2\n"[..], format!("line 1: {numbers}")),
        (b"\"\"\n1\n", format!("line 1: {numbers}")),
        (b"# 2 arms\n1,2\n", format!("line 2: {numbers}")),
        (b"# a b\n1,2\n", "line 1: unknown column".to_owned()),
        (b"x,X\n", "line 1: the columns `x` and `X` are both `x`".to_owned()),
        (b"\xff\xfex\0\n\0", format!("line 1: {UTF_16}")),
    ] {
        assert_eq!(records(text)[0], Err(expected), "{text:?}");
    }
}

/// Checks that messages cannot control a terminal.
#[test]
fn messages_contain_excerpts_of_fields() {
    let long = "\u{1b}z".repeat(10_000);
    for (text, expected) in [
        (format!("x;\n{long}\n"), "x: `\\u{1b}z"),
        (format!("x;\n\"{long}\" 2;\n"), "there is text after the quoted field \"\\u{1b}z"),
    ] {
        let records = records(text.as_bytes());
        let [Ok((2, Err(message)))] = &*records else { panic!("{records:?}") };
        assert!(message.starts_with(expected) && message.len() < 500, "{message}");
    }
    let choose = |names: &[String]| {
        Ok::<_, String>(vec![
            Some(RecordColumn { key: "x".to_owned(), is_text: false });
            names.len()
        ])
    };
    let read = |text: &str| match Records::new(text.as_bytes(), choose).next().unwrap() {
        Ok((_, record)) => record.unwrap_err(),
        Err(error) => error.to_string(),
    };
    let message = read(&format!("{long},{long}1\n"));
    assert!(message.starts_with("line 1: the columns `\\u{1b}z"), "{message}");
    assert!(message.ends_with("...` are both `x`") && message.len() < 1000, "{message}");
    let message = read(&format!("{long}\na\n"));
    assert!(message.starts_with("\\u{1b}z") && message.ends_with("...: `a` is not a number"));
}
