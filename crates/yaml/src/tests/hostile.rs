//! Tests malicious inputs: each ends with a message, quickly and in bounded memory.

use super::super::*;
use super::Camera;
use proptest::prelude::*;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

/// Returns the processor time of this thread. On systems other than Linux, returns the elapsed time.
fn worked() -> Duration {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let line = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let ns = line.split(' ').next().and_then(|ns| ns.parse().ok());
    ns.map_or_else(|| START.elapsed(), Duration::from_nanos)
}

/// Returns the value of `run`, and checks that it takes less than a second of processor time, whatever else runs at the same time.
fn soon<T>(run: impl FnOnce() -> T) -> T {
    let start = worked();
    let value = run();
    let took = worked().saturating_sub(start);
    assert!(took < Duration::from_secs(1), "took {took:?}");
    value
}

/// Returns the first faults of a malicious text, and checks that parsing takes less than a second.
fn refused(text: String) -> String {
    let typed = soon(|| parse(SourceFile::new("t.yaml", text.clone())).and_then(|node| node.parse::<Camera>()));
    typed.expect_err("hostile").to_string().chars().take(300).collect()
}

#[test]
fn deep_nesting_is_refused() {
    for text in ["[", "{a: ", "- ", "? ", "[{a: ", "{? "] {
        let said = refused(text.repeat(10_000));
        assert!(said.contains("nested deeper than 64 levels") || said.contains("never closed"), "{text}: {said}");
    }
    let blocks: String = (0..2000).map(|depth| format!("{}a:\n", " ".repeat(depth))).collect();
    assert!(refused(blocks).contains("nested deeper than 64 levels"));
}

#[test]
fn deepest_nesting_is_read_and_dropped() {
    let text = |depth: usize| format!("{}{}", "[".repeat(depth), "]".repeat(depth));
    assert!(parse(SourceFile::new("t.yaml", text(MAX_DEPTH))).is_ok());
    let refused = parse(SourceFile::new("t.yaml", text(MAX_DEPTH + 1))).unwrap_err();
    assert!(refused.to_string().starts_with("t.yaml:1:65: nested deeper"), "{refused}");
}

#[test]
fn aliases_are_bounded() {
    let mut laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_owned();
    for level in 1..40 {
        let names = vec![format!("*a{}", level - 1); 10].join(", ");
        laughs += &format!("a{level}: &a{level} [{names}]\n");
    }
    assert!(refused(laughs).contains("more than 200000 values"));

    // Aliases nest deeply although the text does not.
    let mut deep = "a0: &a0 [x]\n".to_owned();
    for level in 1..100 {
        deep += &format!("a{level}: &a{level} [*a{}]\n", level - 1);
    }
    assert!(refused(deep).contains("nested deeper than 64 levels"));

    // Anchors in anchors are not copied until they are used.
    let anchors: String = (0..60).map(|i| format!("&b{i} [")).collect();
    let wide = format!("a: {anchors}{}{}", "1, ".repeat(150_000), "]".repeat(60));
    assert!(soon(|| parse(SourceFile::new("t.yaml", wide.clone()))).is_ok());
}

#[test]
fn large_files_are_refused() {
    let said = refused("x".repeat(100_000_000));
    assert!(said.contains("100000000 bytes, at most 4194304 are read"), "{said}");
}

#[test]
fn many_values_and_long_texts_are_bounded() {
    assert!(refused(format!("[{}]", "1,".repeat(1_000_000))).contains("more than 200000 values"));
    assert!(refused("a:\n".repeat(90_000)).contains("appears twice"));
    assert!(refused((0..300_000).map(|i| format!("k{i}:\n")).collect()).contains("more than 200000 values"));
    let long = refused(format!("radius: {}", "x".repeat(4_000_000)));
    assert!(long.len() < 300 && long.contains("found the text `xxx"), "{long}");
    let key = refused(format!("{}: 1", "x".repeat(1000)));
    assert!(key.contains("unknown key `xxx"), "{key}");
    for entry in ["[],", "{},", "a: b,", "[{a: 1}],"] {
        refused(format!("[{}]", entry.repeat(66_000)));
    }
    refused(format!("'{}", "\n".repeat(4_000_000)));
    refused("#\n".repeat(2_000_000));
    refused("a: 'b\n".repeat(600_000));
    refused(format!("\"{}\"", "\\u0041".repeat(600_000)));
    refused("&a ".repeat(1_000_000));
    refused(format!("{}]", "[1, {a: 2}, ".repeat(60)));
}

#[test]
fn many_faults_are_cut() {
    let text = format!("surfaces:\n{}", "- {radius: 1 s, glas: 2, thickness: x}\n".repeat(30_000));
    let tree = parse(SourceFile::new("t.yaml", text)).unwrap();
    let faults = soon(|| tree.parse::<Camera>()).unwrap_err();
    assert_eq!(faults.len(), 101);
    assert!(faults.0[100].message.contains("more than 100 faults"));
    let twice = parse(SourceFile::new("t.yaml", "a:\n".repeat(1000))).unwrap_err();
    assert_eq!(twice.len(), 101);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Checks that no bytes cause a panic, and that each fault lies inside its file.
    #[test]
    fn any_bytes_end_in_a_word(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        sound(&bytes)?;
    }

    /// Checks the same for texts that look like YAML.
    #[test]
    fn any_yaml_like_text_ends_in_a_word(
        parts in prop::collection::vec(
            prop::sample::select(vec![
                "a", "radius", "focus", "surfaces", ": ", ":", "- ", "-", "\n", "\n  ", "\n    ", "[", "]", "{", "}", ", ", "&x ", "*x", "!t ",
                "'", "\"", "#", " ", "\t", "|\n", ">-\n", "? ", "1", "2 mm", "1/125 s", "f/2", ".inf", "~", "<<", "---", "...", "%", "@",
                "\u{e9}", "\u{1f600}", "\r\n", "\u{feff}", "\\", "\\u00", "\0", "\u{85}", "\u{2028}",
            ]),
            0..60,
        )
    ) {
        sound(parts.concat().as_bytes())?;
    }

    /// Checks that overrides do not panic, and that a refused override changes nothing.
    #[test]
    fn any_override_ends_in_a_word(argument in "[a-c.\\[\\]0-3= :{},\"-]{0,30}") {
        let mut root = parse(SourceFile::new("t.yaml", "a: {b: 1, c: [1, {a: 2}]}\nb:\n")).unwrap();
        let before = format!("{root:?}");
        if parse_override(&argument).is_ok_and(|set| set.apply(&mut root).is_err()) {
            prop_assert_eq!(before, format!("{:?}", root));
        }
    }
}

fn sound(bytes: &[u8]) -> Result<(), TestCaseError> {
    let faults = match parse_bytes("t.yaml", bytes) {
        Ok(node) => match node.parse::<Camera>() {
            Ok(_) => return Ok(()),
            Err(faults) => faults,
        },
        Err(faults) => faults,
    };
    prop_assert!(!faults.is_empty());
    for fault in &faults {
        if let Some((file, span)) = &fault.place {
            let end = span.offset + span.len;
            prop_assert!(file.text.get(span.offset..end).is_some(), "{:?} of {:?}", span, file.text);
            // Line and column agree with the offset.
            let before = &file.text[..span.offset];
            let lines = before.replace("\r\n", "\n").replace('\r', "\n");
            prop_assert_eq!(span.line, 1 + lines.matches('\n').count(), "{:?} {:?}", fault, file.text);
            let last = lines.rsplit('\n').next().unwrap_or("");
            // A byte order mark counts as a column inside a text and not elsewhere.
            if !last.contains('\u{feff}') {
                prop_assert_eq!(span.column, 1 + last.chars().count(), "{:?} {:?}", fault, file.text);
            }
        }
    }
    Ok(())
}
