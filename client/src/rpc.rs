//! The calls: names, routes, and which of them may be repeated. Both transports read this table.

use http::Method;
use serde::{Serialize, de::DeserializeOwned};
use takt_proto::v1;

use crate::retry::Safety;

/// One call of the service.
pub(crate) trait Rpc: 'static {
    type Request: prost::Message + Clone + Serialize + Default + 'static;
    type Response: prost::Message + DeserializeOwned + Default + 'static;
    /// Path of the gRPC method.
    const GRPC_PATH: &'static str;

    /// What a repetition would do.
    fn safety(_request: &Self::Request) -> Safety {
        Safety::Repeatable
    }

    /// The robot that the request is about; `None` where it is about none.
    fn robot_id(request: &Self::Request) -> Option<&str>;

    /// The same call over HTTP.
    fn route(request: &Self::Request) -> Route<Self::Request>;
}

/// Where a request goes over HTTP, and what of it travels in the body.
pub(crate) struct Route<M> {
    pub(crate) method: Method,
    pub(crate) path: String,
    pub(crate) body: Option<M>,
}

impl<M> Route<M> {
    fn bare(method: Method, path: String) -> Self {
        Self {
            method,
            path,
            body: None,
        }
    }
}

/// Escapes a path segment or a query value; the unreserved characters of RFC 3986 stay as they are.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}

fn robot_path(robot_id: &str) -> String {
    format!("/v1/robots/{}", escape(robot_id))
}

/// A query string of the values that are there.
fn query(pairs: &[(&str, Option<String>)]) -> String {
    let mut out = String::new();
    for (name, value) in pairs {
        if let Some(value) = value {
            out.push(if out.is_empty() { '?' } else { '&' });
            out.push_str(name);
            out.push('=');
            out.push_str(&escape(value));
        }
    }
    out
}

/// The calls that post a request about a robot and read the answer.
macro_rules! verb {
    ($name:ident, $request:ident, $response:ident, $service:literal, $method:literal, $verb:literal) => {
        pub(crate) struct $name;

        impl Rpc for $name {
            type Request = v1::$request;
            type Response = v1::$response;
            const GRPC_PATH: &'static str = concat!("/takt.v1.", $service, "/", $method);

            fn robot_id(request: &Self::Request) -> Option<&str> {
                Some(&request.robot_id)
            }

            fn route(request: &Self::Request) -> Route<Self::Request> {
                let mut body = request.clone();
                body.robot_id.clear();
                Route {
                    method: Method::POST,
                    path: format!("{}:{}", robot_path(&request.robot_id), $verb),
                    body: Some(body),
                }
            }
        }
    };
}

verb!(
    PlanMove,
    PlanMoveRequest,
    PlanMoveResponse,
    "PlanService",
    "PlanMove",
    "planMove"
);
verb!(
    CheckTrajectory,
    CheckTrajectoryRequest,
    CheckTrajectoryResponse,
    "PlanService",
    "CheckTrajectory",
    "checkTrajectory"
);
verb!(
    InverseDynamics,
    InverseDynamicsRequest,
    InverseDynamicsResponse,
    "DynamicsService",
    "InverseDynamics",
    "inverseDynamics"
);
verb!(
    ForwardKinematics,
    ForwardKinematicsRequest,
    ForwardKinematicsResponse,
    "DynamicsService",
    "ForwardKinematics",
    "forwardKinematics"
);

pub(crate) struct RegisterRobot;

impl Rpc for RegisterRobot {
    type Request = v1::RegisterRobotRequest;
    type Response = v1::RegisterRobotResponse;
    const GRPC_PATH: &'static str = "/takt.v1.RobotService/RegisterRobot";

    /// The same content is the same revision, so a repetition changes nothing; but with an expected revision it would
    /// meet the revision that the first execution made, and report a conflict that is none.
    fn safety(request: &Self::Request) -> Safety {
        if request.expected_revision.is_some() && request.validate_only != Some(true) {
            Safety::Once
        } else {
            Safety::Repeatable
        }
    }

    fn robot_id(request: &Self::Request) -> Option<&str> {
        Some(&request.robot_id)
    }

    fn route(request: &Self::Request) -> Route<Self::Request> {
        let mut body = request.clone();
        body.robot_id.clear();
        Route {
            method: Method::PUT,
            path: robot_path(&request.robot_id),
            body: Some(body),
        }
    }
}

pub(crate) struct GetRobot;

impl Rpc for GetRobot {
    type Request = v1::GetRobotRequest;
    type Response = v1::GetRobotResponse;
    const GRPC_PATH: &'static str = "/takt.v1.RobotService/GetRobot";

    fn robot_id(request: &Self::Request) -> Option<&str> {
        Some(&request.robot_id)
    }

    fn route(request: &Self::Request) -> Route<Self::Request> {
        let query = query(&[
            ("revision", request.revision.clone()),
            ("as_urdf", request.as_urdf.map(|yes| yes.to_string())),
        ]);
        Route::bare(Method::GET, robot_path(&request.robot_id) + &query)
    }
}

pub(crate) struct ListRobots;

impl Rpc for ListRobots {
    type Request = v1::ListRobotsRequest;
    type Response = v1::ListRobotsResponse;
    const GRPC_PATH: &'static str = "/takt.v1.RobotService/ListRobots";

    fn robot_id(_request: &Self::Request) -> Option<&str> {
        None
    }

    fn route(request: &Self::Request) -> Route<Self::Request> {
        let query = query(&[
            ("page_size", request.page_size.map(|size| size.to_string())),
            ("page_token", request.page_token.clone()),
        ]);
        Route::bare(Method::GET, format!("/v1/robots{query}"))
    }
}

pub(crate) struct ListRevisions;

impl Rpc for ListRevisions {
    type Request = v1::ListRevisionsRequest;
    type Response = v1::ListRevisionsResponse;
    const GRPC_PATH: &'static str = "/takt.v1.RobotService/ListRevisions";

    fn robot_id(request: &Self::Request) -> Option<&str> {
        Some(&request.robot_id)
    }

    fn route(request: &Self::Request) -> Route<Self::Request> {
        let query = query(&[
            ("page_size", request.page_size.map(|size| size.to_string())),
            ("page_token", request.page_token.clone()),
        ]);
        Route::bare(
            Method::GET,
            format!("{}:revisions{query}", robot_path(&request.robot_id)),
        )
    }
}

pub(crate) struct DeleteRobot;

impl Rpc for DeleteRobot {
    type Request = v1::DeleteRobotRequest;
    type Response = v1::DeleteRobotResponse;
    const GRPC_PATH: &'static str = "/takt.v1.RobotService/DeleteRobot";

    /// A repetition would report that there is no such robot, or delete one that came in between.
    fn safety(_request: &Self::Request) -> Safety {
        Safety::Once
    }

    fn robot_id(request: &Self::Request) -> Option<&str> {
        Some(&request.robot_id)
    }

    fn route(request: &Self::Request) -> Route<Self::Request> {
        let query = query(&[("expected_revision", request.expected_revision.clone())]);
        Route::bare(Method::DELETE, robot_path(&request.robot_id) + &query)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_values_are_escaped() {
        let route = GetRobot::route(&v1::GetRobotRequest {
            robot_id: "a/b:c é".to_owned(),
            revision: Some("r&1".to_owned()),
            as_urdf: Some(true),
        });
        assert_eq!(
            route.path,
            "/v1/robots/a%2Fb%3Ac%20%C3%A9?revision=r%261&as_urdf=true"
        );
    }

    #[test]
    fn the_robot_travels_in_the_path_only() {
        let request = v1::PlanMoveRequest {
            robot_id: "ur5e".to_owned(),
            ..Default::default()
        };
        let route = PlanMove::route(&request);
        assert_eq!(route.path, "/v1/robots/ur5e:planMove");
        assert_eq!(route.body.unwrap().robot_id, "");
    }

    #[test]
    fn only_registrations_without_an_expectation_are_repeatable() {
        let mut request = v1::RegisterRobotRequest::default();
        assert_eq!(RegisterRobot::safety(&request), Safety::Repeatable);
        request.expected_revision = Some(String::new());
        assert_eq!(RegisterRobot::safety(&request), Safety::Once);
        request.validate_only = Some(true);
        assert_eq!(RegisterRobot::safety(&request), Safety::Repeatable);
        assert_eq!(
            DeleteRobot::safety(&v1::DeleteRobotRequest::default()),
            Safety::Once
        );
    }
}
