//! The secret token in the address.

use std::fmt::{self, Debug, Formatter};
use std::io;

const LENGTH: usize = 26;
/// The alphabet: Crockford's base 32, five bits per letter, without letters that are easily confused.
const LETTERS: &[u8; 32] = b"0123456789abcdefghjkmnpqrstvwxyz";

/// A token: 130 random bits as 26 letters.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct AccessToken(String);

impl AccessToken {
    /// Creates a random token. Fails if the system has no random numbers.
    pub(crate) fn new() -> io::Result<Self> {
        let mut bytes = [0; LENGTH];
        getrandom::fill(&mut bytes).map_err(io::Error::from)?;
        let letter = |byte: &u8| LETTERS.get(usize::from(byte & 31)).copied().map_or('0', char::from);
        Ok(Self(bytes.iter().map(letter).collect()))
    }

    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }

    /// Compares the token with a guess in constant time.
    pub(crate) fn is(&self, guess: &str) -> bool {
        let differences = self.0.bytes().zip(guess.bytes()).fold(0, |sum, (own, guess)| sum | (own ^ guess));
        std::hint::black_box(differences) == 0 && self.0.len() == guess.len()
    }
}

impl Debug for AccessToken {
    /// Hides the token from logs.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("AccessToken")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_are_long_random_and_unique() {
        let tokens: Vec<AccessToken> = (0..64).map(|_| AccessToken::new().unwrap()).collect();
        for (place, token) in tokens.iter().enumerate() {
            assert!(token.as_str().len() * 5 >= 128 && token.as_str().bytes().all(|b| LETTERS.contains(&b)));
            assert!(tokens[..place].iter().all(|other| other != token));
        }
        // Every letter occurs at every position, so all bits are random.
        let seen = |place: usize| {
            let letters = (0..2_000).map(|_| AccessToken::new().unwrap().as_str().as_bytes()[place]);
            letters.collect::<std::collections::BTreeSet<u8>>().len()
        };
        assert_eq!((seen(0), seen(LENGTH - 1)), (32, 32));
    }

    #[test]
    fn only_the_exact_token_is_accepted() {
        let token = AccessToken::new().unwrap();
        let text = token.as_str().to_owned();
        assert!(token.is(&text));
        let mut other = text.clone().into_bytes();
        other[LENGTH - 1] = if other[LENGTH - 1] == b'0' { b'1' } else { b'0' };
        let other = String::from_utf8(other).unwrap();
        for guess in ["", &text[1..], &text[..LENGTH - 1], &format!("{text}0"), &other, &text.to_uppercase()]
        {
            assert!(!token.is(guess) || guess == text, "{guess}");
        }
        assert!(!token.is(&"\0".repeat(LENGTH)));
        assert_eq!(format!("{token:?}"), "AccessToken");
    }
}
