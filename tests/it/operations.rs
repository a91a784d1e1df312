//! What operators and tools ask for: health, reflection, the OpenAPI document and its page.

use prost::Message;
use serde_json::Value;
use takt_proto::route::{JSON_LINES, ROUTES, Rpc};
use takt_tests::TestServer;
use tonic::Code;
use tonic_health::pb::{HealthCheckRequest, HealthCheckResponse, health_client::HealthClient};

const SERVICES: [&str; 3] = ["takt.v1.RobotService", "takt.v1.PlanService", "takt.v1.DynamicsService"];

#[tokio::test]
async fn health_is_known_of_every_service() {
    let mut server = TestServer::start().await;
    let (http2, origin) = server.grpc().parts();
    let mut health = HealthClient::with_origin(http2, origin);
    for service in SERVICES.into_iter().chain([""]) {
        let request = HealthCheckRequest {
            service: service.to_owned(),
        };
        let answer: HealthCheckResponse = health.check(request).await.unwrap().into_inner();
        assert_eq!(answer.status, 1, "{service}");
    }
    let request = HealthCheckRequest {
        service: "takt.v1.Nope".to_owned(),
    };
    assert_eq!(health.check(request).await.unwrap_err().code(), Code::NotFound);
    let mut http = server.http().await;
    for (path, text) in [("/healthz", "ok\n"), ("/readyz", "ready\n")] {
        let reply = http.get(path).await;
        assert_eq!((reply.status, reply.text().as_str()), (200, text));
    }
    // Whoever watches is told of the end.
    let mut watched = health.watch(HealthCheckRequest::default()).await.unwrap().into_inner();
    assert_eq!(watched.message().await.unwrap().unwrap().status, 1);
    server.stop();
    assert_eq!(watched.message().await.unwrap().unwrap().status, 2);
}

/// The questions of both versions of reflection are the same.
macro_rules! check_reflection {
    ($version:ident, $server:expr) => {{
        use tonic_reflection::pb::$version::{
            ServerReflectionRequest, server_reflection_client::ServerReflectionClient,
            server_reflection_request::MessageRequest, server_reflection_response::MessageResponse,
        };
        let (http2, origin) = $server.grpc().parts();
        let mut client = ServerReflectionClient::with_origin(http2, origin);
        let questions = [
            MessageRequest::ListServices(String::new()),
            MessageRequest::FileContainingSymbol("takt.v1.PlanService".to_owned()),
            MessageRequest::FileByFilename("takt/v1/plan.proto".to_owned()),
            MessageRequest::FileContainingSymbol("takt.v1.Nope".to_owned()),
        ];
        let questions = questions.map(|question| ServerReflectionRequest {
            host: String::new(),
            message_request: Some(question),
        });
        let mut answers = client
            .server_reflection_info(futures::stream::iter(questions))
            .await
            .unwrap()
            .into_inner();
        let mut next = async || answers.message().await.unwrap().unwrap().message_response.unwrap();
        let MessageResponse::ListServicesResponse(list) = next().await else {
            panic!("no list of services");
        };
        let names: Vec<&str> = list.service.iter().map(|service| service.name.as_str()).collect();
        for service in SERVICES.into_iter().chain(["grpc.health.v1.Health"]) {
            assert!(names.contains(&service), "{service} in {names:?}");
        }
        for _ in 0..2 {
            let MessageResponse::FileDescriptorResponse(files) = next().await else {
                panic!("no file");
            };
            for file in files.file_descriptor_proto {
                let file = prost_types::FileDescriptorProto::decode(&*file).unwrap();
                assert_eq!(file.package(), "takt.v1");
            }
        }
        // Unknown symbols end the stream, or are answered with an error; either way the server goes on.
        let _ = answers.message().await;
    }};
}

#[tokio::test]
async fn reflection_answers_in_both_versions() {
    let server = TestServer::start().await;
    check_reflection!(v1, server);
    check_reflection!(v1alpha, server);
    assert_eq!(server.http().await.get("/healthz").await.status, 200);
}

#[tokio::test]
async fn the_openapi_document_is_whole() {
    let server = TestServer::start().await;
    let reply = server.http().await.get("/openapi.json").await;
    assert_eq!(
        (reply.status, reply.header("content-type")),
        (200, Some("application/json"))
    );
    let document = reply.json();
    assert!(
        document["openapi"]
            .as_str()
            .is_some_and(|version| version.starts_with("3."))
    );
    for route in ROUTES {
        let operation = &document["paths"][route.path][route.method.as_str().to_ascii_lowercase()];
        assert_eq!(operation["operationId"], route.rpc.name(), "{route:?}");
        assert!(operation["responses"]["200"].is_object(), "{route:?}");
    }
    let mut reference_count = 0;
    for_each_reference(&document, &mut |reference| {
        let pointer = reference
            .strip_prefix('#')
            .expect("references stay within the document");
        assert!(document.pointer(pointer).is_some(), "{reference} leads nowhere");
        reference_count += 1;
    });
    assert!(reference_count > 20, "{reference_count}");
}

fn for_each_reference(value: &Value, see: &mut impl FnMut(&str)) {
    match value {
        Value::Object(members) => {
            if let Some(reference) = members.get("$ref").and_then(Value::as_str) {
                see(reference);
            }
            members.values().for_each(|member| for_each_reference(member, see));
        }
        Value::Array(entries) => entries.iter().for_each(|entry| for_each_reference(entry, see)),
        _ => {}
    }
}

/// What the document shows as an example can be sent as it is.
#[tokio::test]
async fn the_examples_of_the_openapi_document_are_accepted() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    let document = http.get("/openapi.json").await.json();
    for route in ROUTES.iter().filter(|route| route.method.has_body()) {
        let operation = &document["paths"][route.path][route.method.as_str().to_ascii_lowercase()];
        let kind = match route.rpc.takes_stream() {
            true => JSON_LINES,
            false => "application/json",
        };
        let example = &operation["requestBody"]["content"][kind]["example"];
        assert!(example.is_object(), "{route:?}");
        let kind = [("content-type", kind)];
        let robot = if route.rpc == Rpc::RegisterRobot {
            "mine"
        } else {
            "ur5e"
        };
        let (method, path) = (route.method.as_str(), route.path_for(robot));
        let reply = http.request(method, &path, &kind, example.to_string().as_bytes()).await;
        assert_eq!(reply.status, 200, "{route:?}: {}", reply.text());
        let answered = match route.rpc.gives_stream() {
            true => JSON_LINES,
            false => "application/json",
        };
        assert_eq!(reply.header("content-type"), Some(answered), "{route:?}");
        assert!(
            operation["responses"]["200"]["content"][answered].is_object(),
            "{route:?}"
        );
        // A stream that began well may still end badly.
        assert!(!reply.text().contains("\"error\""), "{route:?}: {}", reply.text());
    }
}

/// A cell has no internet.
#[tokio::test]
async fn pages_load_nothing_from_elsewhere() {
    let server = TestServer::start().await;
    let mut http = server.http().await;
    for path in ["/", "/docs"] {
        let reply = http.get(path).await;
        assert_eq!(
            (reply.status, reply.header("content-type")),
            (200, Some("text/html; charset=utf-8"))
        );
        let text = reply.text();
        for load in [
            "src=\"http",
            "src='http",
            "src=\"//",
            "url(http",
            "url(//",
            "@import",
            "import(",
            "<link",
            "<iframe",
        ] {
            assert!(!text.contains(load), "{path} loads by {load}");
        }
        for (at, _) in text.match_indices("fetch(") {
            let call = &text[at..(at + 40).min(text.len())];
            assert!(!call.contains("//"), "{path}: {call}");
        }
    }
}
