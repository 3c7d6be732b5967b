//! Server endpoints, limits and threads.

use std::{
    net::{IpAddr, SocketAddr, TcpListener},
    sync::Arc,
    time::Duration,
};

use opcua::{
    crypto::{SecurityPolicy, hostname},
    server::{
        Limits, Server, ServerBuilder, ServerEndpoint, ServerHandle,
        node_manager::memory::InMemoryNodeManagerBuilder,
    },
    types::{BuildInfo, MessageSecurityMode},
};
use tokio::runtime::Runtime;

use crate::{
    certificates::Certificates,
    error::OpcUaError,
    nodesets,
    options::OpcUaOptions,
    robots::{RobotPlan, Robots, RobotsManager},
    users::Users,
};

/// Update interval of subscriptions, in ms, and the shortest interval available to clients.
const TICK_MS: u64 = 10;
/// Maximum number of concurrent sessions.
const MAX_SESSIONS: usize = 32;
/// Time-out of open connections at shutdown.
const SHUTDOWN: Duration = Duration::from_secs(1);

/// A server that runs until it is dropped.
pub(crate) struct RunningServer {
    /// `None` during shutdown.
    runtime: Option<Runtime>,
    handle: ServerHandle,
    pub(crate) robots: Arc<RobotsManager>,
    pub(crate) certificates: Certificates,
    pub(crate) address: SocketAddr,
}

impl RunningServer {
    pub(crate) fn start(
        options: &OpcUaOptions,
        robots: Vec<RobotPlan>,
    ) -> Result<Self, OpcUaError> {
        if options.users.is_empty() && !options.anonymous && !options.unsecured {
            let message = "no user can log in: name users, or allow anonymous users".to_owned();
            return Err(OpcUaError::Server { message });
        }
        let users = Users::new(options.users.clone(), options.anonymous)?;
        let node_sets = nodesets::all()?;
        let address = options.listen;
        let listen = |source| OpcUaError::Listen { address, source };
        let listener = TcpListener::bind(address).map_err(listen)?;
        listener.set_nonblocking(true).map_err(listen)?;
        let address = listener.local_addr().map_err(listen)?;

        let computer = hostname().unwrap_or_else(|_| "localhost".to_owned());
        let host = options.host.clone().unwrap_or_else(|| host_of(address.ip(), &computer));
        let application_uri = format!("urn:{computer}:iiwasim");
        let hosts = [host.clone(), computer, "localhost".to_owned()];
        let certificates = Certificates::open(&options.certificates, &application_uri, &hosts)?;
        for file in &options.trusted {
            certificates.trust(file)?;
        }

        let mut builder = ServerBuilder::new()
            .application_name("iiwasim")
            .application_uri(application_uri)
            .product_uri("urn:iiwasim")
            .build_info(BuildInfo {
                product_uri: "urn:iiwasim".into(),
                manufacturer_name: "iiwasim".into(),
                product_name: "iiwasim".into(),
                software_version: env!("CARGO_PKG_VERSION").into(),
                ..BuildInfo::default()
            })
            .pki_dir(certificates.folder())
            .discovery_urls(vec![format!("opc.tcp://{host}:{}/", address.port())])
            .host(host)
            .port(address.port())
            .limits(limits())
            .subscription_poll_interval_ms(TICK_MS)
            .with_authenticator(Arc::new(users))
            .with_node_manager(InMemoryNodeManagerBuilder::new(move |context, space: &mut _| {
                Robots::insert(robots, node_sets, &context, space)
            }));
        for (name, endpoint) in endpoints(options.unsecured) {
            builder = builder.add_endpoint(name, endpoint);
        }
        let failed = |message: String| OpcUaError::Server { message };
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_name("opcua")
            .enable_all()
            .build()
            .map_err(|source| OpcUaError::Runtime { source })?;
        // The builder starts tasks, so it needs the runtime context.
        let (server, handle) = {
            let _inside = runtime.enter();
            builder.build().map_err(failed)?
        };
        let robots = handle
            .node_managers()
            .get_of_type::<RobotsManager>()
            .ok_or_else(|| failed("it has no robots".to_owned()))?;
        runtime.spawn(run(server, listener));
        Ok(Self { runtime: Some(runtime), handle, robots, certificates, address })
    }

    /// Publishes values.
    pub(crate) fn publish(&self, values: &[(opcua::types::NodeId, opcua::types::DataValue)]) {
        let values = values.iter().map(|(node, value)| (node, None, value.clone()));
        if let Err(error) = self.robots.set_values(self.handle.subscriptions(), values) {
            tracing::warn!("OPC UA: values were not published: {error}");
        }
    }
}

impl Drop for RunningServer {
    fn drop(&mut self) {
        self.handle.cancel();
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_timeout(SHUTDOWN);
        }
    }
}

async fn run(server: Server, listener: TcpListener) {
    let ended = match tokio::net::TcpListener::from_std(listener) {
        Ok(listener) => server.run_with(listener).await,
        Err(error) => Err(error.to_string()),
    };
    if let Err(error) = ended {
        tracing::error!("the OPC UA server has ended: {error}");
    }
}

/// Returns the host name for clients. An unspecified address cannot be connected to, so the
/// computer name replaces it.
fn host_of(address: IpAddr, computer: &str) -> String {
    match address {
        address if address.is_unspecified() => computer.to_owned(),
        IpAddr::V6(address) => format!("[{address}]"),
        IpAddr::V4(address) => address.to_string(),
    }
}

/// Returns the endpoints. The policies `Basic128Rsa15` and `Basic256`, which the OPC Foundation has
/// withdrawn, are not included.
fn endpoints(unsecured: bool) -> Vec<(String, ServerEndpoint)> {
    let policies = [
        SecurityPolicy::Basic256Sha256,
        SecurityPolicy::Aes128Sha256RsaOaep,
        SecurityPolicy::Aes256Sha256RsaPss,
    ];
    let modes = [MessageSecurityMode::Sign, MessageSecurityMode::SignAndEncrypt];
    let mut all: Vec<_> =
        policies.into_iter().flat_map(|policy| modes.map(|mode| (policy, mode))).collect();
    if unsecured {
        all.push((SecurityPolicy::None, MessageSecurityMode::None));
    }
    let named = all.into_iter().map(|(policy, mode)| {
        (format!("{policy} {mode}"), ServerEndpoint::new("/", policy, mode, &[]))
    });
    named.collect()
}

fn limits() -> Limits {
    let mut limits = Limits { max_sessions: MAX_SESSIONS, ..Limits::default() };
    #[expect(clippy::cast_precision_loss, reason = "some tens")]
    let shortest = TICK_MS as f64;
    limits.subscriptions.min_publishing_interval_ms = shortest;
    limits.subscriptions.min_sampling_interval_ms = shortest;
    limits
}
