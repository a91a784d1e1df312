//! The robots' URLs: queries, and revisions as entity tags.

use http::{HeaderMap, HeaderValue, Uri, header};

use super::{
    Answered, Call, Http, IntoResponse as _, Invalid, Query, Request, ServiceError, StatusCode, add_etag, quoted, v1,
};

impl Http {
    pub(super) async fn list_robots(&self, uri: &Uri) -> Answered {
        let mut query = Query::of(uri);
        let message = v1::ListRobotsRequest {
            page_size: query.value("page_size", "a number"),
            page_token: query.text("page_token"),
        };
        query.finish()?;
        let answer = self.service.list_robots(message).await?;
        self.json.write_now(&answer)
    }

    pub(super) async fn register_robot(&self, request: Request, id: String, call: Call) -> Answered {
        let expected = expected_revision(request.headers())?;
        let mut message: v1::RegisterRobotRequest = self.json.read_for(request, id, call).await?;
        if let Some(expected) = expected {
            let stated = message.expected_revision.get_or_insert_with(|| expected.clone());
            if *stated != expected {
                let message = format!(
                    "{} is not the revision of the header, {}",
                    quoted(stated),
                    quoted(&expected)
                );
                return Err(ServiceError::invalid(vec![Invalid::new("expected_revision", message)]));
            }
        }
        let answer = self.service.register_robot(call, message).await?;
        let revision = answer.message.robot.as_ref().map(|robot| robot.revision.clone());
        let mut response = self.json.write(answer, call).await?;
        add_etag(&mut response, &revision.unwrap_or_default());
        Ok(response)
    }

    pub(super) async fn get_robot(&self, uri: &Uri, headers: &HeaderMap, id: String, call: Call) -> Answered {
        let mut query = Query::of(uri);
        let message = v1::GetRobotRequest {
            robot_id: id,
            revision: query.text("revision"),
            as_urdf: query.value("as_urdf", "true or false"),
        };
        query.finish()?;
        let answer = self.service.get_robot(call, message).await?;
        let revision = answer.message.robot.as_ref().map(|robot| robot.revision.clone());
        let revision = revision.unwrap_or_default();
        let mut response = if has_tag(headers, &header::IF_NONE_MATCH, &revision) {
            StatusCode::NOT_MODIFIED.into_response()
        } else {
            self.json.write(answer, call).await?
        };
        add_etag(&mut response, &revision);
        Ok(response)
    }

    pub(super) async fn list_revisions(&self, uri: &Uri, id: String) -> Answered {
        let mut query = Query::of(uri);
        let message = v1::ListRevisionsRequest {
            robot_id: id,
            page_size: query.value("page_size", "a number"),
            page_token: query.text("page_token"),
        };
        query.finish()?;
        let answer = self.service.list_revisions(message).await?;
        self.json.write_now(&answer)
    }

    pub(super) async fn delete_robot(&self, uri: &Uri, headers: &HeaderMap, id: String) -> Answered {
        let mut query = Query::of(uri);
        let in_query = query.text("expected_revision");
        query.finish()?;
        let message = v1::DeleteRobotRequest {
            robot_id: id,
            expected_revision: in_query.or(expected_revision(headers)?),
        };
        let answer = self.service.delete_robot(message).await?;
        self.json.write_now(&answer)
    }
}

/// The revision that `If-Match` names; none may be there with `If-None-Match: *`.
fn expected_revision(headers: &HeaderMap) -> Result<Option<String>, ServiceError> {
    if headers.get(header::IF_NONE_MATCH).is_some_and(|value| value == "*") {
        return Ok(Some(String::new()));
    }
    let Some(value) = headers.get(header::IF_MATCH) else {
        return Ok(None);
    };
    let tag = value.to_str().ok().map(str::trim);
    let tag = tag.and_then(|tag| tag.strip_prefix('"')?.strip_suffix('"'));
    match tag {
        Some(tag) if !tag.contains('"') => Ok(Some(tag.to_owned())),
        _ => {
            let message = "must be one entity tag: a revision in double quotes";
            Err(ServiceError::invalid(vec![Invalid::new("if-match", message)]))
        }
    }
}

/// Whether a header lists a revision among its entity tags.
fn has_tag(headers: &HeaderMap, name: &header::HeaderName, revision: &str) -> bool {
    let values = headers.get_all(name).iter();
    let mut tags = values
        .filter_map(|value: &HeaderValue| value.to_str().ok())
        .flat_map(|value| value.split(','));
    tags.any(|tag| {
        let tag = tag.trim();
        let tag = tag.strip_prefix("W/").unwrap_or(tag);
        tag == "*" || tag.trim_matches('"') == revision
    })
}
