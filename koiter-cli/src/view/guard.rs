//! Who may ask: the page that this server sent, in a browser on this machine.
//!
//! The server listens on the loopback address alone. Other pages of the same browser reach that too: by a name that they
//! let resolve to it (then `Host` is theirs), or by a request across origins (then `Origin` or `Sec-Fetch-Site` say so).
//! What changes something also needs a token that only the page knows.

use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};

use super::http::{Answer, Request};

/// What requests are held against.
#[derive(Debug)]
pub(super) struct Guard {
    hosts: [String; 2],
    pub(super) token: String,
}

impl Guard {
    pub(super) fn new(port: u16) -> Self {
        // Each hasher has secret keys from the system's source of randomness.
        let word = || RandomState::new().build_hasher().finish();
        Self {
            hosts: [format!("127.0.0.1:{port}"), format!("localhost:{port}")],
            token: format!("{:016x}{:016x}", word(), word()),
        }
    }

    /// # Errors
    /// The answer to a request that comes from elsewhere.
    pub(super) fn check(&self, request: &Request) -> Result<(), Answer> {
        let is_here = |host: &str| self.hosts.iter().any(|known| known == host);
        if !is_here(&request.host) {
            return Err(Answer::error(
                403,
                "this server answers to its own address only",
            ));
        }
        let origin_is_here = |origin: &str| origin.strip_prefix("http://").is_some_and(is_here);
        let origin_is_wrong = request
            .origin
            .as_deref()
            .is_some_and(|o| !origin_is_here(o));
        let site_is_wrong =
            (request.site.as_deref()).is_some_and(|site| site != "same-origin" && site != "none");
        if origin_is_wrong || site_is_wrong {
            return Err(Answer::error(403, "another page asks, which may not"));
        }
        let token_is_right = request.token.as_deref() == Some(&*self.token);
        if request.is_post && !token_is_right {
            return Err(Answer::error(
                403,
                "the token is missing or wrong: load the page anew",
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(host: &str) -> Request {
        Request {
            host: host.to_owned(),
            ..Request::default()
        }
    }

    #[test]
    fn only_its_own_names_and_origin_are_answered() {
        let guard = Guard::new(80);
        for host in ["127.0.0.1:80", "localhost:80"] {
            assert!(guard.check(&request(host)).is_ok());
        }
        for host in [
            "",
            "127.0.0.1",
            "localhost:81",
            "evil.example:80",
            "127.0.0.1:80 ",
        ] {
            assert!(guard.check(&request(host)).is_err(), "{host}");
        }
        let with_origin = |origin: &str| Request {
            origin: Some(origin.to_owned()),
            ..request("localhost:80")
        };
        assert!(guard.check(&with_origin("http://localhost:80")).is_ok());
        for origin in [
            "null",
            "http://evil.example",
            "https://localhost:80",
            "http://localhost:81",
        ] {
            assert!(guard.check(&with_origin(origin)).is_err(), "{origin}");
        }
        let cross_site = Request {
            site: Some("cross-site".to_owned()),
            ..request("localhost:80")
        };
        assert!(guard.check(&cross_site).is_err());
    }

    #[test]
    fn what_changes_something_needs_the_token_of_this_server() {
        let (guard, other) = (Guard::new(80), Guard::new(80));
        assert_eq!(guard.token.len(), 32);
        assert_ne!(guard.token, other.token);
        let post = |token: Option<&str>| Request {
            is_post: true,
            token: token.map(str::to_owned),
            ..request("localhost:80")
        };
        assert!(guard.check(&post(Some(&guard.token))).is_ok());
        assert!(guard.check(&post(Some(&other.token))).is_err());
        assert!(guard.check(&post(Some(""))).is_err());
        assert!(guard.check(&post(None)).is_err());
    }
}
