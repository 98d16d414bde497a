//! Which address answers what. Nothing of an address is a path of a file: results, frames and fields are numbers.
//!
//! ```text
//! /                              the page, with its token
//! /viewer.js /viewer.css         what belongs to it
//! /api/results                   what there is, a list
//! /api/results/R/state           times of the frames, whether the run goes on
//! /api/results/R/topology        u32 × 3 a face
//! /api/results/R/frames/K        f32 × 3 a vertex; ?field=F adds f32 a vertex or face
//! /api/results/R/range?field=F   {"low", "high"} of the colours
//! /api/results/R/history         ?vertex=V or ?face=F: position and fields over time
//! /api/results/R/stats, /probes  figures a step, a list a column
//! /api/results/R/scene           the scene as it was run
//! /api/results/R/request         POST pause, continue or stop
//! /api/results/R/hand            POST "V x y z", to pull a vertex there, or "released"
//! ```

use koiter::io::result::Element;
use serde_json::json;

use super::guard::Guard;
use super::http::{Answer, Request, parse_number};
use super::page::Page;
use super::shown::Shown;

/// Everything that is served.
pub(super) struct Site {
    pub(super) guard: Guard,
    pub(super) page: Page,
    pub(super) results: Vec<Shown>,
}

impl Site {
    /// The answer to a request.
    pub(super) fn answer(&self, request: &Request) -> Answer {
        if let Err(refusal) = self.guard.check(request) {
            return refusal;
        }
        let words: Vec<&str> = request.path.split('/').skip(1).collect();
        let known = match words[..] {
            ["api", "results", result, ref rest @ ..] if !rest.is_empty() => {
                let result = parse_number(result).and_then(|index| self.results.get(index));
                result.and_then(|result| of_result(result, rest, request))
            }
            _ if request.is_post => None,
            [""] => Some(Answer::new(HTML, self.page.html(&self.guard.token))),
            ["viewer.js"] => Some(Answer::new(
                "text/javascript; charset=utf-8",
                self.page.script,
            )),
            ["viewer.css"] => Some(Answer::new("text/css; charset=utf-8", self.page.style)),
            ["api", "results"] => {
                let infos = self.results.iter().map(Shown::info);
                Some(Answer::json(&infos.collect::<Vec<_>>()))
            }
            _ => None,
        };
        known.unwrap_or_else(|| Answer::error(404, "there is nothing here"))
    }
}

const HTML: &str = "text/html; charset=utf-8";

fn of_result(result: &Shown, words: &[&str], request: &Request) -> Option<Answer> {
    let asked = match words {
        ["request"] if request.is_post => Some(result.request(&request.body)),
        ["hand"] if request.is_post => Some(result.pull(&request.body)),
        _ => None,
    };
    if let Some(asked) = asked {
        return Some(match asked {
            Ok(()) => Answer::json(&json!({})),
            Err(message) => Answer::error(409, &message),
        });
    }
    if request.is_post {
        return None;
    }
    let element = || {
        let vertex = request.number("vertex").map(Element::Vertex);
        vertex.or(request.number("face").map(Element::Face))
    };
    let json = |value: Result<serde_json::Value, String>| match value {
        Ok(value) => Answer::json(&value),
        Err(message) => Answer::error(500, &message),
    };
    Some(match words {
        ["state"] => json(result.state()),
        ["topology"] => Answer::binary(result.topology()),
        ["frames", index] => match result.frame(parse_number(index)?, request.number("field")) {
            Ok(bytes) => Answer::binary(bytes),
            Err(message) => Answer::error(500, &message),
        },
        ["range"] => json(result.range(request.number("field")?)),
        ["history"] => json(result.history(element()?)),
        ["stats"] => json(result.stats()),
        ["probes"] => json(result.probes()),
        ["scene"] => Answer::new("text/plain; charset=utf-8", result.scene()),
        _ => return None,
    })
}
