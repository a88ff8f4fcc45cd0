//! `monitor`: the page of a run, served.

use std::net::{IpAddr, SocketAddr};
use std::path::Path;
use std::sync::Arc;

use anyhow::Context;

use super::terminal::{say, warn};
use crate::monitor::{Server, is_built_in};
use crate::study::monitor::Watched;

/// Serves the run in `path` at `address` until the process ends.
pub(super) fn run(path: &Path, address: IpAddr, port: u16) -> anyhow::Result<()> {
    let watched = Watched::open(path)?;
    let address = SocketAddr::new(address, port);
    let server = Server::bind(address).with_context(|| {
        format!("{address} is not free; choose another with --port, or --port 0 for any")
    })?;
    let address = server.address()?;
    say(&format!("http://{address}/"));
    if !is_built_in() {
        warn("this program was built without its page: run scripts/web, build again");
    }
    if !address.ip().is_loopback() {
        warn(&format!("everybody who reaches {address} may look at {}", path.display()));
    }
    Ok(server.serve(Arc::new(watched))?)
}
