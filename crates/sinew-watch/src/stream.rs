//! Connections of notifications: TCP, and TLS over it.

use std::path::Path;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;

/// Connection to a receiver of notifications.
pub(crate) trait Stream: AsyncRead + AsyncWrite + Unpin + Send {}

impl<T: AsyncRead + AsyncWrite + Unpin + Send> Stream for T {}

/// Connects to a host, whose IPv6 address may be in brackets.
///
/// # Errors
/// Returns the reason as text.
pub(crate) async fn connect(host: &str, port: u16) -> Result<Box<dyn Stream>, String> {
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    match TcpStream::connect((bare, port)).await {
        Ok(stream) => Ok(Box::new(stream)),
        Err(error) => Err(error.to_string()),
    }
}

/// Begins TLS on a connection. The certificate of the host must be valid for its name, and issued by an authority of
/// `ca_file`, or without one by an authority that the operating system trusts.
///
/// # Errors
/// Returns the reason as text.
#[cfg(feature = "tls")]
pub(crate) async fn secure(
    plain: Box<dyn Stream>,
    host: &str,
    ca_file: Option<&Path>,
) -> Result<Box<dyn Stream>, String> {
    use tokio_rustls::TlsConnector;
    use tokio_rustls::rustls::crypto::ring;
    use tokio_rustls::rustls::pki_types::ServerName;
    use tokio_rustls::rustls::{ClientConfig, RootCertStore};

    let mut roots = RootCertStore::empty();
    roots.add_parsable_certificates(authorities(ca_file)?);
    if roots.is_empty() {
        return Err(
            "no certificate authorities found; install ca-certificates, or set ca_file".into(),
        );
    }
    let config = ClientConfig::builder_with_provider(ring::default_provider().into());
    let config = config.with_safe_default_protocol_versions();
    let config = config.map_err(|e| e.to_string())?;
    let config = config.with_root_certificates(roots).with_no_client_auth();
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    let name = ServerName::try_from(bare.to_owned()).map_err(|e| e.to_string())?;
    let connector = TlsConnector::from(std::sync::Arc::new(config));
    match connector.connect(name, plain).await {
        Ok(stream) => Ok(Box::new(stream)),
        Err(error) => Err(format!("TLS: {error}")),
    }
}

/// Reads the certificates of the trusted authorities.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or has no certificate.
#[cfg(feature = "tls")]
fn authorities(
    ca_file: Option<&Path>,
) -> Result<Vec<tokio_rustls::rustls::pki_types::CertificateDer<'static>>, String> {
    use tokio_rustls::rustls::pki_types::CertificateDer;
    use tokio_rustls::rustls::pki_types::pem::PemObject as _;

    let Some(path) = ca_file else {
        // Certificates of the operating system that cannot be read are not trusted.
        return Ok(rustls_native_certs::load_native_certs().certs);
    };
    let text = sinew_files::read_text(path, &sinew_files::Budget::SETTINGS);
    let text = text.map_err(|e| e.to_string())?;
    let read: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(text.as_bytes()).collect();
    let invalid = |reason: String| format!("{}: {reason}", path.display());
    match read {
        Ok(certificates) if certificates.is_empty() => Err(invalid("no PEM certificate".into())),
        Ok(certificates) => Ok(certificates),
        Err(error) => Err(invalid(error.to_string())),
    }
}

/// Reports that this build has no TLS.
///
/// # Errors
/// Always returns the reason as text.
#[cfg(not(feature = "tls"))]
pub(crate) async fn secure(
    _plain: Box<dyn Stream>,
    _host: &str,
    _ca_file: Option<&Path>,
) -> Result<Box<dyn Stream>, String> {
    Err("this build has no TLS; install sinew-watch with its feature tls".into())
}

/// Checks the file of certificate authorities.
///
/// # Errors
/// Returns the reason as text if the file cannot be read or has no certificate.
pub(crate) fn check_authorities(ca_file: &Path) -> Result<(), String> {
    #[cfg(feature = "tls")]
    authorities(Some(ca_file))?;
    #[cfg(not(feature = "tls"))]
    let _unused = ca_file;
    Ok(())
}
