//! The calls: which of them may be repeated, and what of a request travels in the URL. Names and URLs are the route
//! table's, which the server reads too.

use serde::{Serialize, de::DeserializeOwned};
use takt_proto::{
    route::{self, HttpMethod, Route},
    v1,
};

use crate::retry::Safety;

/// One call of the service.
pub(crate) trait Rpc: 'static {
    type Request: prost::Message + Clone + Serialize + Default + 'static;
    type Response: prost::Message + DeserializeOwned + Default + 'static;
    /// Its row in the route table.
    const RPC: route::Rpc;

    /// What a repetition would do.
    fn safety(_request: &Self::Request) -> Safety {
        Safety::Repeatable
    }

    /// The robot that the request is about; `None` where it is about none.
    fn robot_id(request: &Self::Request) -> Option<&str>;

    /// The request without what is in the URL.
    fn body(request: &Self::Request) -> Self::Request;

    /// The fields of a request that travels without a body.
    fn query(_request: &Self::Request) -> Query {
        Vec::new()
    }
}

/// A call that streams requests.
pub(crate) trait Streamed: Rpc {
    /// A request that says which robot it is about, and nothing else.
    fn about(robot_id: &str) -> Self::Request;
}

/// Fields of a request by name; absent ones are left out.
type Query = Vec<(&'static str, Option<String>)>;

/// Path of the gRPC method.
pub(crate) fn grpc_path<R: Rpc>() -> String {
    format!("/{}/{}", Route::of(R::RPC).service, R::RPC.name())
}

/// Where a request goes over HTTP, and what of it travels in the body.
pub(crate) struct HttpRoute<M> {
    pub(crate) method: HttpMethod,
    pub(crate) path: String,
    pub(crate) body: Option<M>,
}

/// The same call over HTTP.
pub(crate) fn http_route<R: Rpc>(request: &R::Request) -> HttpRoute<R::Request> {
    let route = Route::of(R::RPC);
    let mut path = route.path_for(&escape(R::robot_id(request).unwrap_or_default()));
    if route.method.has_body() {
        return HttpRoute {
            method: route.method,
            path,
            body: Some(R::body(request)),
        };
    }
    let given = R::query(request)
        .into_iter()
        .filter_map(|(name, value)| Some((name, value?)));
    for (index, (name, value)) in given.enumerate() {
        path.push(if index == 0 { '?' } else { '&' });
        path.push_str(name);
        path.push('=');
        path.push_str(&escape(&value));
    }
    HttpRoute {
        method: route.method,
        path,
        body: None,
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

/// A call about a robot; what follows the messages are the functions that differ from the usual.
macro_rules! about_a_robot {
    ($name:ident, $request:ident => $response:ident $(, $($rest:item)*)?) => {
        pub(crate) struct $name;

        impl Rpc for $name {
            type Request = v1::$request;
            type Response = v1::$response;
            const RPC: route::Rpc = route::Rpc::$name;

            fn robot_id(request: &Self::Request) -> Option<&str> {
                Some(&request.robot_id)
            }

            fn body(request: &Self::Request) -> Self::Request {
                let mut body = request.clone();
                body.robot_id.clear();
                body
            }

            $($($rest)*)?
        }
    };
}

about_a_robot!(PlanMove, PlanMoveRequest => PlanMoveResponse);
about_a_robot!(PlanPath, PlanPathRequest => PlanPathResponse);
about_a_robot!(PlanBatch, PlanBatchRequest => PlanBatchResponse);
about_a_robot!(EstimateFriction, EstimateFrictionRequest => EstimateFrictionResponse);
about_a_robot!(FitDrive, FitDriveRequest => FitDriveResponse);
about_a_robot!(Rehearse, RehearseRequest => RehearseResponse);
about_a_robot!(StreamSetpoints, StreamSetpointsRequest => StreamSetpointsResponse);
about_a_robot!(CheckTrajectory, CheckTrajectoryRequest => CheckTrajectoryResponse);
about_a_robot!(InverseDynamics, InverseDynamicsRequest => InverseDynamicsResponse);
about_a_robot!(ForwardKinematics, ForwardKinematicsRequest => ForwardKinematicsResponse);
about_a_robot!(InverseKinematics, InverseKinematicsRequest => InverseKinematicsResponse);

macro_rules! streamed {
    ($($name:ident)*) => {
        $(impl Streamed for $name {
            fn about(robot_id: &str) -> Self::Request {
                Self::Request {
                    robot_id: robot_id.to_owned(),
                    ..Default::default()
                }
            }
        })*
    };
}

streamed!(PlanBatch EstimateFriction);

about_a_robot!(RegisterRobot, RegisterRobotRequest => RegisterRobotResponse,
    /// The same content is the same revision, so a repetition changes nothing; but with an expected revision it would
    /// meet the revision that the first execution made, and report a conflict that is none.
    fn safety(request: &Self::Request) -> Safety {
        if request.expected_revision.is_some() && request.validate_only != Some(true) {
            Safety::Once
        } else {
            Safety::Repeatable
        }
    }
);

about_a_robot!(GetRobot, GetRobotRequest => GetRobotResponse,
    fn query(request: &Self::Request) -> Query {
        vec![
            ("revision", request.revision.clone()),
            ("as_urdf", request.as_urdf.map(|yes| yes.to_string())),
        ]
    }
);

about_a_robot!(ListRevisions, ListRevisionsRequest => ListRevisionsResponse,
    fn query(request: &Self::Request) -> Query {
        vec![
            ("page_size", request.page_size.map(|size| size.to_string())),
            ("page_token", request.page_token.clone()),
        ]
    }
);

about_a_robot!(DeleteRobot, DeleteRobotRequest => DeleteRobotResponse,
    /// A repetition would report that there is no such robot, or delete one that came in between.
    fn safety(_request: &Self::Request) -> Safety {
        Safety::Once
    }

    fn query(request: &Self::Request) -> Query {
        vec![("expected_revision", request.expected_revision.clone())]
    }
);

pub(crate) struct ListRobots;

impl Rpc for ListRobots {
    type Request = v1::ListRobotsRequest;
    type Response = v1::ListRobotsResponse;
    const RPC: route::Rpc = route::Rpc::ListRobots;

    fn robot_id(_request: &Self::Request) -> Option<&str> {
        None
    }

    fn body(request: &Self::Request) -> Self::Request {
        request.clone()
    }

    fn query(request: &Self::Request) -> Query {
        vec![
            ("page_size", request.page_size.map(|size| size.to_string())),
            ("page_token", request.page_token.clone()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_values_are_escaped() {
        let route = http_route::<GetRobot>(&v1::GetRobotRequest {
            robot_id: "a/b:c é".to_owned(),
            revision: Some("r&1".to_owned()),
            as_urdf: Some(true),
        });
        assert_eq!(route.path, "/v1/robots/a%2Fb%3Ac%20%C3%A9?revision=r%261&as_urdf=true");
        let all = http_route::<ListRobots>(&v1::ListRobotsRequest::default());
        assert_eq!(all.path, "/v1/robots");
    }

    #[test]
    fn the_robot_travels_in_the_path_only() {
        let request = v1::PlanMoveRequest {
            robot_id: "ur5e".to_owned(),
            ..Default::default()
        };
        let route = http_route::<PlanMove>(&request);
        assert_eq!(route.path, "/v1/robots/ur5e:planMove");
        assert_eq!(route.body.unwrap().robot_id, "");
        assert_eq!(grpc_path::<PlanMove>(), "/takt.v1.PlanService/PlanMove");
    }

    #[test]
    fn only_registrations_without_an_expectation_are_repeatable() {
        let mut request = v1::RegisterRobotRequest::default();
        assert_eq!(RegisterRobot::safety(&request), Safety::Repeatable);
        request.expected_revision = Some(String::new());
        assert_eq!(RegisterRobot::safety(&request), Safety::Once);
        request.validate_only = Some(true);
        assert_eq!(RegisterRobot::safety(&request), Safety::Repeatable);
        assert_eq!(DeleteRobot::safety(&v1::DeleteRobotRequest::default()), Safety::Once);
    }
}
