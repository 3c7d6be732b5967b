//! The header for C is the one that cbindgen makes from the sources.

use std::{fs, path::Path};

use cbindgen::{Builder, Config};

/// `IIWASIM_RENEW=1 cargo test -p iiwasim-peers --features peers c_header` writes it anew.
#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../crates/front/iiwa-c"));
    let config = Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let made = Builder::new().with_crate(folder).with_config(config).generate().unwrap();
    let mut text = Vec::new();
    made.write(&mut text);
    let header = folder.join("include/iiwasim.h");
    if std::env::var_os("IIWASIM_RENEW").is_some() {
        fs::write(&header, &text).unwrap();
    }
    let text = String::from_utf8(text).unwrap();
    // Where git writes lines as Windows has them.
    let committed = fs::read_to_string(&header).unwrap_or_default().replace("\r\n", "\n");
    assert!(
        committed == text,
        "include/iiwasim.h is not what the sources say: \
         IIWASIM_RENEW=1 cargo test -p iiwasim-peers --features peers c_header writes it anew"
    );
}
