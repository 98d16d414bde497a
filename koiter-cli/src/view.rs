//! `koiter view`: the viewer, on the loopback address of this machine.

mod columns;
mod guard;
mod history;
mod html;
mod http;
mod mesh;
mod page;
mod quantised;
mod routes;
mod server;
mod shown;
#[cfg(test)]
mod tests;

use std::net::{Ipv4Addr, TcpListener};
use std::process::{Command, Stdio};

use serde_json::json;

use crate::arguments::ViewArguments;
use crate::failure::{Code, Failure};
use crate::output::say;
use guard::Guard;
pub(crate) use html::{html, html_frames};
pub(crate) use page::Page;
use routes::Site;
use shown::Shown;

/// How to get a program that holds the page.
pub(crate) const HOW_TO_BUNDLE: &str = "with Node.js 20 or later and npm on the path, build Koiter again: KOITER_VIEWER=require cargo build --release";

/// Serves the viewer until the process is ended.
pub(crate) fn view(arguments: &ViewArguments) -> Result<(), Failure> {
    let results = (arguments.shown.iter())
        .map(|path| Shown::open(path))
        .collect::<Result<Vec<_>, _>>()?;
    let page = bundled_page()?;
    let port = arguments.port.unwrap_or(0);
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(|error| {
        Failure::input(format!("cannot listen on port {port}: {error}"))
            .with_help("leave --port out: a free one is found")
    })?;
    let address = listener.local_addr().map_err(Failure::run)?;
    let url = format!("http://{address}/");
    if arguments.json {
        say!("{}", json!({ "url": url, "port": address.port() }));
    } else {
        say!("viewer: {url} (Ctrl-C ends it)");
    }
    if !arguments.no_open && !open_browser(&url) {
        log::warn!(target: "koiter", "no browser could be opened: open the address above");
    }
    let site = Site {
        guard: Guard::new(address.port()),
        page,
        results,
    };
    server::serve(&listener, move |request| site.answer(request));
    Ok(())
}

/// The page that this program holds.
pub(crate) fn bundled_page() -> Result<Page, Failure> {
    Page::bundled().map_err(|reason| {
        Failure::run(format!(
            "this program was built without the viewer: {reason}"
        ))
        .with_code(Code::Viewer)
        .with_help(HOW_TO_BUNDLE)
    })
}

/// Asks the system to open the page; whether that could be asked.
fn open_browser(url: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/c", "start"])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(url);
    let silent = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    silent.spawn().is_ok()
}
