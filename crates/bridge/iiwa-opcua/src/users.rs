//! User access: reading, and stopping robots.

use std::time::Duration;

use async_trait::async_trait;
use opcua::{
    crypto::SecurityPolicy,
    server::{
        ANONYMOUS_USER_TOKEN_ID, ServerEndpoint,
        authenticator::{AuthManager, Password, UserToken, user_pass_security_policy_id},
    },
    types::{Error, NodeId, StatusCode, UAString, UserTokenPolicy, UserTokenType},
};

use iiwa_bridge::Credentials;

use crate::OpcUaError;

/// Policy identifier of the server library for users without a name.
const ANONYMOUS_POLICY: &str = "anonymous";

/// Delay of the response to a wrong name or password, which limits the number of attempts.
const REFUSAL_DELAY: Duration = Duration::from_secs(1);

/// Authenticates users.
pub(crate) struct Users {
    users: Vec<Credentials>,
    anonymous: bool,
}

impl Users {
    /// Creates the authenticator for these users, and for anonymous ones if `anonymous`.
    pub(crate) fn new(users: Vec<Credentials>, anonymous: bool) -> Result<Self, OpcUaError> {
        for (i, Credentials { user, password }) in users.iter().enumerate() {
            let fault = if user.is_empty() || password.is_empty() {
                "needs a name and a password"
            } else if users[..i].iter().any(|other| other.user == *user) {
                "is named twice"
            } else {
                continue;
            };
            return Err(OpcUaError::Settings {
                message: format!("the OPC UA user `{user}` {fault}"),
            });
        }
        Ok(Self { users, anonymous })
    }

    /// Returns true if the password belongs to the user. All entries are compared completely, so
    /// that the duration reveals neither names nor prefixes of passwords.
    fn knows(&self, name: &str, password: &str) -> bool {
        self.users.iter().fold(false, |is_known, user| {
            is_known | (same(&user.user, name) & same(&user.password, password))
        })
    }

    fn allows_anonymous(&self, endpoint: &ServerEndpoint) -> bool {
        self.anonymous || endpoint.security_policy() == SecurityPolicy::None
    }
}

/// Returns true if two texts are equal, in a time that depends on their lengths only.
fn same(expected: &str, given_text: &str) -> bool {
    let lengths = u8::from(expected.len() != given_text.len());
    let bytes = expected.bytes().zip(given_text.bytes());
    bytes.fold(lengths, |differences, (a, b)| differences | (a ^ b)) == 0
}

#[async_trait]
impl AuthManager for Users {
    async fn authenticate_anonymous_token(&self, endpoint: &ServerEndpoint) -> Result<(), Error> {
        if self.allows_anonymous(endpoint) {
            return Ok(());
        }
        Err(Error::new(StatusCode::BadIdentityTokenRejected, "users need a name and a password"))
    }

    async fn authenticate_username_identity_token(
        &self,
        endpoint: &ServerEndpoint,
        name: &str,
        password: &Password,
    ) -> Result<UserToken, Error> {
        // Without security, the password would be readable on the network, so it is not accepted
        // there.
        let secure = endpoint.security_policy() != SecurityPolicy::None;
        if secure && self.knows(name, password.get()) {
            return Ok(UserToken(name.to_owned()));
        }
        tracing::warn!("OPC UA: a wrong user name or password");
        tokio::time::sleep(REFUSAL_DELAY).await;
        Err(Error::new(StatusCode::BadUserAccessDenied, "wrong user name or password"))
    }

    // Anonymous users have read access only.
    fn is_user_executable(&self, token: &UserToken, _: &NodeId) -> bool {
        token.0 != ANONYMOUS_USER_TOKEN_ID
    }

    fn user_token_policies(&self, endpoint: &ServerEndpoint) -> Vec<UserTokenPolicy> {
        let policy = |id: UAString, token_type: UserTokenType| UserTokenPolicy {
            policy_id: id,
            token_type,
            issued_token_type: UAString::null(),
            issuer_endpoint_url: UAString::null(),
            security_policy_uri: UAString::null(),
        };
        let anonymous = self
            .allows_anonymous(endpoint)
            .then(|| policy(ANONYMOUS_POLICY.into(), UserTokenType::Anonymous));
        let secure = endpoint.security_policy() != SecurityPolicy::None;
        let named = (secure && !self.users.is_empty())
            .then(|| policy(user_pass_security_policy_id(endpoint), UserTokenType::UserName));
        anonymous.into_iter().chain(named).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn user(name: &str, password: &str) -> Credentials {
        Credentials { user: name.to_owned(), password: password.to_owned() }
    }

    #[test]
    fn only_whole_passwords_of_the_same_user_count() {
        let users = vec![user("anna", "anna-secret"), user("ben", "ben-secret")];
        let users = Users::new(users, false).unwrap();
        assert!(users.knows("anna", "anna-secret") && users.knows("ben", "ben-secret"));
        for (name, password) in [
            ("anna", "ben-secret"),
            ("anna", "anna-secre"),
            ("anna", "anna-secret "),
            ("anna", ""),
            ("", ""),
            ("Anna", "anna-secret"),
        ] {
            assert!(!users.knows(name, password), "{name} {password}");
        }
    }

    #[test]
    fn indistinguishable_users_are_refused() {
        let refused = |users: &[Credentials]| Users::new(users.to_vec(), false).is_err();
        assert!(refused(&[user("anna", "a"), user("anna", "b")]));
        assert!(refused(&[user("", "secret")]) && refused(&[user("anna", "")]));
    }
}
