//! TLS: the keys of a server, and the handshake with a client.
//!
//! Only TLS 1.3: every browser since 2020 speaks it, and what is not there cannot be attacked.

use std::io;
use std::sync::Arc;

use rustls::ServerConfig;
use rustls::crypto::ring::default_provider;
use rustls::pki_types::pem::PemObject as _;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio::io::AsyncWriteExt as _;
use tokio::net::TcpStream;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::server::TlsStream;

/// The first byte of a TLS connection: a record of the handshake.
const HANDSHAKE: u8 = 22;

/// What a client reads that speaks plain HTTP. It may have been led here by an old link.
const PLAIN: &[u8] =
    b"HTTP/1.1 400 Bad Request\r\ncontent-type: text/plain; charset=utf-8\r\ncontent-length: 64\r\n\
    connection: close\r\n\r\nthis port is encrypted: begin the address with https:// instead\n";

/// A certificate with its key.
#[derive(Clone)]
pub struct Tls(TlsAcceptor);

impl std::fmt::Debug for Tls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Tls")
    }
}

/// Why a certificate and a key cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TlsError {
    /// There is no certificate in the file of certificates.
    #[error("there is no certificate in PEM form in it")]
    NoCertificate,
    /// There is no key in the file of the key.
    #[error("there is no private key in PEM form in it, without a password")]
    NoKey,
    /// They do not fit each other, or are of a kind that is not known.
    #[error("the key cannot be used with the certificate: {0}")]
    Unfit(#[from] rustls::Error),
}

impl Tls {
    /// Takes a certificate, with those that vouch for it behind it, and its private key; both in PEM form.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn new(certificate: &[u8], key: &[u8]) -> Result<Self, TlsError> {
        let chain: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(certificate).collect();
        let chain = chain.ok().filter(|chain| !chain.is_empty()).ok_or(TlsError::NoCertificate)?;
        let key = PrivateKeyDer::from_pem_slice(key).map_err(|_| TlsError::NoKey)?;
        let mut config = ServerConfig::builder_with_provider(Arc::new(default_provider()))
            .with_protocol_versions(&[&rustls::version::TLS13])?
            .with_no_client_auth()
            .with_single_cert(chain, key)?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(Self(TlsAcceptor::from(Arc::new(config))))
    }

    /// Shakes hands with a client, which takes as long as the client lets it. One that speaks plain HTTP is told so.
    pub(super) async fn accept(&self, mut stream: TcpStream) -> io::Result<TlsStream<TcpStream>> {
        let mut first = [0];
        if stream.peek(&mut first).await? == 1 && first != [HANDSHAKE] {
            // What has come is read: a system that closes with bytes unread takes back what it has sent.
            let _ = stream.try_read(&mut [0; 4096]);
            stream.write_all(PLAIN).await?;
            stream.shutdown().await?;
            return Err(io::Error::other("it speaks no TLS"));
        }
        self.0.accept(stream).await
    }
}

/// Makes a certificate for these names and addresses, which vouches for itself, and its key; both in PEM form. It is valid for as long as the machine
/// will be there. A browser asks a person about it once, and would ask again after each change.
///
/// # Errors
/// A name that is none, as a sentence.
pub fn self_signed(names: &[String]) -> Result<[String; 2], String> {
    let said = |error: rcgen::Error| error.to_string();
    let mut parameters = rcgen::CertificateParams::new(names).map_err(said)?;
    let name = names.first().map_or("andon", String::as_str);
    parameters.distinguished_name = rcgen::DistinguishedName::new();
    parameters.distinguished_name.push(rcgen::DnType::CommonName, name);
    parameters.not_before = rcgen::date_time_ymd(2020, 1, 1);
    parameters.not_after = rcgen::date_time_ymd(2070, 1, 1);
    let key = rcgen::KeyPair::generate().map_err(said)?;
    let certificate = parameters.self_signed(&key).map_err(said)?;
    Ok([certificate.pem(), key.serialize_pem()])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_certificate_and_a_key_that_do_not_fit_are_refused_with_what_is_wrong() {
        let names = ["bench1.plant.example".to_owned(), "10.0.0.7".to_owned()];
        let [certificate, key] = self_signed(&names).unwrap();
        let [_, other] = self_signed(&names).unwrap();
        assert!(Tls::new(certificate.as_bytes(), key.as_bytes()).is_ok());
        let refused = |certificate: &str, key: &str| {
            Tls::new(certificate.as_bytes(), key.as_bytes()).unwrap_err().to_string()
        };
        assert!(refused("", &key).contains("no certificate"));
        assert!(refused(&key, &key).contains("no certificate"));
        assert!(refused(&certificate, &certificate).contains("no private key"));
        assert!(refused(&certificate, &other).contains("cannot be used with the certificate"));
        assert!(self_signed(&["no name\u{7f}\u{fc}".to_owned()]).is_err());
    }

    #[test]
    fn what_a_client_without_tls_reads_says_its_own_length() {
        let text = std::str::from_utf8(PLAIN).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        assert!(head.contains(&format!("content-length: {}", body.len())), "{}", body.len());
    }
}
