use super::*;

fn examples() -> Vec<Error> {
    vec![
        Error::new(ErrorCode::NotFound, "no robot \"a\""),
        Error::invalid(vec![
            Invalid::new("start.position[1]", "NaN is not a finite number"),
            Invalid::new("limits[0].joint", "no joint \"x\""),
        ]),
        Error::conflict("abc", "the current revision is abc"),
        Error::overloaded("planner queue", "too busy", Duration::from_millis(50)),
    ]
}

#[test]
fn both_encodings_carry_everything() {
    for error in examples() {
        assert_eq!(Error::from_status(&error.to_status()), error);
        let body = error.to_json().to_string();
        assert_eq!(Error::from_json(body.as_bytes()), Some(error));
    }
}

/// `docs/errors.md` shows the table; `TAKT_UPDATE=1` writes it again.
#[test]
fn the_documented_table_is_this_one() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/errors.md");
    let mut text = String::from(HEAD);
    for row in TABLE {
        let retry = match row.retry {
            Retry::No => "no",
            Retry::AfterReading => "after reading the current revision again",
            Retry::AfterDelay => "after the delay that it states",
            Retry::WithMoreTime => "with more time",
        };
        text.push_str(&format!("| {:?} | {} | {} | {retry} |\n", row.code, row.name, row.http));
    }
    if std::env::var_os("TAKT_UPDATE").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(path).unwrap(), text);
}

const HEAD: &str = "# Errors\n\n\
    A refusal is a `google.rpc.Status` on either protocol: in the trailers over gRPC, as `{\"error\": {code, status,\n\
    message, details}}` over HTTP. `details` holds `google.rpc.BadRequest` (every violation, with the path of its\n\
    field), `RetryInfo` and `ErrorInfo` (domain `takt`). A motion that cannot be is no error: it is the outcome\n\
    `infeasible`, with its evidence.\n\n\
    | code | gRPC | HTTP | try again |\n|---|---|---|---|\n";

#[test]
fn json_has_the_form_of_a_status() {
    let json = examples()[1].to_json();
    assert_eq!(json["error"]["code"], 3);
    assert_eq!(json["error"]["status"], "INVALID_ARGUMENT");
    let detail = &json["error"]["details"][0];
    assert_eq!(detail["@type"], "type.googleapis.com/google.rpc.BadRequest");
    assert_eq!(detail["field_violations"][0]["field"], "start.position[1]");
}

#[test]
fn details_stay_within_what_headers_can_hold() {
    let long = Invalid::new("joints[0].name", "é".repeat(5000));
    let error = Error::invalid(vec![long; 1000]);
    let status = error.to_status();
    assert!(status.details().len() + status.message().len() < 6000);
}
