//! The routes: which URL over HTTP is which method over gRPC. The server's router, the OpenAPI document and the client
//! all read this one table.

/// Method of an HTTP request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum HttpMethod {
    Get,
    Put,
    Post,
    Delete,
}

/// One RPC and its URL.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Route {
    /// Method over HTTP.
    pub method: HttpMethod,
    /// Path over HTTP, with `{robot_id}` where the request's robot id goes. The other fields of the request are in the
    /// body (PUT and POST) or in the query (GET and DELETE).
    pub path: &'static str,
    /// Full name of the gRPC service.
    pub service: &'static str,
    /// Name of the gRPC method.
    pub rpc: Rpc,
}

macro_rules! routes {
    ($($rpc:ident: $method:ident $path:literal in $service:literal,)*) => {
        /// The RPCs that have a URL.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs, reason = "named as in the schema")]
        pub enum Rpc {
            $($rpc,)*
        }

        impl Rpc {
            /// The name in the schema.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$rpc => stringify!($rpc),)*
                }
            }
        }

        /// Every RPC that has a URL.
        pub const ROUTES: &[Route] = &[
            $(Route { method: HttpMethod::$method, path: $path, service: concat!("takt.v1.", $service), rpc: Rpc::$rpc },)*
        ];
    };
}

routes! {
    ListRobots: Get "/v1/robots" in "RobotService",
    RegisterRobot: Put "/v1/robots/{robot_id}" in "RobotService",
    GetRobot: Get "/v1/robots/{robot_id}" in "RobotService",
    DeleteRobot: Delete "/v1/robots/{robot_id}" in "RobotService",
    ListRevisions: Get "/v1/robots/{robot_id}:revisions" in "RobotService",
    PlanMove: Post "/v1/robots/{robot_id}:planMove" in "PlanService",
    PlanPath: Post "/v1/robots/{robot_id}:planPath" in "PlanService",
    PlanBatch: Post "/v1/robots/{robot_id}:planBatch" in "PlanService",
    StreamSetpoints: Post "/v1/robots/{robot_id}:streamSetpoints" in "PlanService",
    CheckTrajectory: Post "/v1/robots/{robot_id}:checkTrajectory" in "PlanService",
    InverseDynamics: Post "/v1/robots/{robot_id}:inverseDynamics" in "DynamicsService",
    ForwardKinematics: Post "/v1/robots/{robot_id}:forwardKinematics" in "DynamicsService",
    InverseKinematics: Post "/v1/robots/{robot_id}:inverseKinematics" in "DynamicsService",
    EstimateFriction: Post "/v1/robots/{robot_id}:estimateFriction" in "DriveService",
    FitDrive: Post "/v1/robots/{robot_id}:fitDrive" in "DriveService",
    Rehearse: Post "/v1/robots/{robot_id}:rehearse" in "DriveService",
}

/// What streams are called over HTTP: one JSON document a line.
pub const JSON_LINES: &str = "application/x-ndjson";

impl Rpc {
    /// Whether requests come as a stream.
    #[must_use]
    pub fn takes_stream(self) -> bool {
        matches!(self, Self::PlanBatch | Self::EstimateFriction)
    }

    /// Whether answers come as a stream.
    #[must_use]
    pub fn gives_stream(self) -> bool {
        matches!(self, Self::PlanBatch | Self::StreamSetpoints | Self::EstimateFriction)
    }
}

/// What a URL leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Match<'a> {
    /// A route, and the text in the place of `{robot_id}`: not checked, empty where the path has no such place.
    Found(&'static Route, &'a str),
    /// The path is known, but not with this method; these it has.
    OtherMethod(Vec<HttpMethod>),
    /// No such path.
    Unknown,
}

impl HttpMethod {
    /// The name in a request line.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Get => "GET",
            Self::Put => "PUT",
            Self::Post => "POST",
            Self::Delete => "DELETE",
        }
    }

    /// Whether the request travels in the body; else in the query.
    #[must_use]
    pub fn has_body(self) -> bool {
        matches!(self, Self::Put | Self::Post)
    }
}

impl Route {
    /// The route of an RPC.
    #[must_use]
    pub fn of(rpc: Rpc) -> &'static Self {
        let found = ROUTES.iter().find(|route| route.rpc == rpc);
        found.unwrap_or(&ROUTES[0])
    }

    /// The path with a robot's id in it. Ids need no escaping.
    #[must_use]
    pub fn path_for(&self, robot_id: &str) -> String {
        self.path.replace("{robot_id}", robot_id)
    }

    /// The text in the place of `{robot_id}`, where the path matches.
    fn matches<'a>(&self, path: &'a str) -> Option<&'a str> {
        let Some((before, verb)) = self.path.split_once("{robot_id}") else {
            return (self.path == path).then_some("");
        };
        let rest = path.strip_prefix(before)?;
        if rest.is_empty() || rest.contains('/') {
            return None;
        }
        match verb.strip_prefix(':') {
            Some(verb) => {
                let (id, found) = rest.rsplit_once(':')?;
                (found == verb).then_some(id)
            }
            None => (!rest.contains(':')).then_some(rest),
        }
    }
}

/// Looks a decoded path up.
#[must_use]
pub fn find<'a>(method: &str, path: &'a str) -> Match<'a> {
    let mut others = Vec::new();
    for route in ROUTES {
        let Some(id) = route.matches(path) else {
            continue;
        };
        if route.method.as_str() == method {
            return Match::Found(route, id);
        }
        others.push(route.method);
    }
    if others.is_empty() {
        Match::Unknown
    } else {
        Match::OtherMethod(others)
    }
}

/// The RPC of a path over gRPC, `/` service `/` method.
#[must_use]
pub fn find_rpc(path: &str) -> Option<Rpc> {
    let (service, method) = path.strip_prefix('/')?.split_once('/')?;
    let mut routes = ROUTES.iter();
    let found = routes.find(|route| route.rpc.name() == method && route.service == service);
    found.map(|route| route.rpc)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rpc_is_found_by_its_path() {
        for route in ROUTES {
            let path = format!("/{}/{}", route.service, route.rpc.name());
            assert_eq!(find_rpc(&path), Some(route.rpc));
            assert_eq!(find_rpc(&path[1..]), None);
            assert_eq!(find_rpc(&format!("{path}/")), None);
        }
        assert_eq!(find_rpc("/takt.v1.RobotService/PlanMove"), None);
    }

    #[test]
    fn every_route_finds_itself() {
        for route in ROUTES {
            let path = route.path_for("arm-1");
            let id = if route.path.contains('{') { "arm-1" } else { "" };
            assert_eq!(find(route.method.as_str(), &path), Match::Found(route, id));
            assert_eq!(Route::of(route.rpc), route);
        }
    }

    #[test]
    fn other_paths_and_methods_are_told_apart() {
        assert_eq!(find("GET", "/v1/robots/"), Match::Unknown);
        assert_eq!(find("GET", "/v1/robots/a/b"), Match::Unknown);
        assert_eq!(find("POST", "/v1/robots/a:fly"), Match::Unknown);
        let others = Match::OtherMethod(vec![HttpMethod::Post]);
        assert_eq!(find("GET", "/v1/robots/a:planMove"), others);
    }
}
