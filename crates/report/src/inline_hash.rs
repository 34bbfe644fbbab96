//! Hashes of what stands in a page, for its content security policy.

/// What a page's content security policy says of a style or a script that stands in the page: the hash of its text.
pub fn inline_hash(text: &str) -> String {
    use base64ct::{Base64, Encoding};
    use sha2::{Digest, Sha256};
    format!("'sha256-{}'", Base64::encode_string(&Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hash of nothing, and the example of the specification (Content Security Policy 3, section 8.3).
    #[test]
    fn hashes_are_those_that_browsers_compute() {
        assert_eq!(inline_hash(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
        assert_eq!(
            inline_hash("alert('Hello, world.');"),
            "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='"
        );
    }
}
