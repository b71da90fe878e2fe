//! Files out of a bucket, by the S3 protocol.

use super::{Address, Needed};
use crate::FleetError;
use crate::folder::{BASELINES, RECORDS, SIDES, TYPES};
use futures::{StreamExt as _, TryStreamExt as _, stream};
use object_store::aws::{AmazonS3, AmazonS3Builder, AmazonS3ConfigKey};
use object_store::client::{HttpError, HttpErrorKind};
use object_store::path::Path as Key;
use object_store::{
    ClientOptions, Error, ObjectMeta, ObjectStore, ObjectStoreExt as _, RetryConfig,
};
use sinew_files::AtomicFile;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// Number of files fetched concurrently.
const MAX_CONCURRENT_FILES: usize = 8;
/// Timeout of a connection attempt.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// Timeout of one page of a bucket listing.
const LIST_TIMEOUT: Duration = Duration::from_secs(30);
/// Timeout of a file transfer before the remainder is requested again.
const FILE_TIMEOUT: Duration = Duration::from_secs(120);
/// Number of retries of a request, and their total duration.
const RETRIES: (usize, Duration) = (2, Duration::from_secs(10));

/// Result of a fetch: temporary folder, number of files and bytes.
pub(super) struct Fetched {
    pub(super) folder: TempDir,
    pub(super) files: usize,
    pub(super) bytes: u64,
}

/// Connection to a bucket.
struct Bucket<'a> {
    store: AmazonS3,
    address: &'a Address,
    /// Endpoint for messages.
    endpoint: String,
    /// Whether the environment provides credentials or specifies that none are needed.
    has_credentials: bool,
}

/// Copies the required files of a folder.
///
/// # Errors
/// Returns [`FleetError`] if the bucket cannot be read or a file cannot be written.
pub(super) fn fetch(address: &Address, needed: Needed) -> Result<Fetched, FleetError> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|e| FleetError::Engine(format!("cannot start the network runtime: {e}")))?;
    let folder = tempfile::Builder::new()
        .prefix("sinew-fleet-")
        .tempdir()
        .map_err(|source| FleetError::Folder {
            path: std::env::temp_dir(),
            source,
        })?;
    let bucket = Bucket::open(address)?;
    let (files, bytes) = runtime.block_on(bucket.copy(needed, folder.path()))?;
    Ok(Fetched {
        folder,
        files,
        bytes,
    })
}

/// Whether the environment provides credentials or specifies that none are needed.
fn has_credentials(builder: &AmazonS3Builder) -> bool {
    use AmazonS3ConfigKey as K;
    let keys = [
        K::AccessKeyId,
        K::WebIdentityTokenFile,
        K::ContainerCredentialsRelativeUri,
        K::ContainerCredentialsFullUri,
    ];
    let unsigned = builder.get_config_value(&K::SkipSignature);
    keys.iter().any(|k| builder.get_config_value(k).is_some())
        || unsigned.as_deref() == Some("true")
}

impl<'a> Bucket<'a> {
    fn open(address: &'a Address) -> Result<Self, FleetError> {
        let builder = AmazonS3Builder::from_env().with_bucket_name(&address.bucket);
        let of = |key: AmazonS3ConfigKey| builder.get_config_value(&key);
        let endpoint =
            of(AmazonS3ConfigKey::S3Endpoint).or_else(|| of(AmazonS3ConfigKey::Endpoint));
        let has_credentials = has_credentials(&builder);
        // An explicit http:// endpoint permits plain HTTP.
        let plain = endpoint.as_ref().is_some_and(|e| e.starts_with("http://"));
        let options = ClientOptions::new()
            .with_allow_http(plain)
            .with_connect_timeout(CONNECT_TIMEOUT)
            .with_timeout(FILE_TIMEOUT);
        let store = builder
            .with_client_options(options)
            .with_retry(RetryConfig {
                max_retries: RETRIES.0,
                retry_timeout: RETRIES.1,
                ..RetryConfig::default()
            })
            .build()
            .map_err(|e| FleetError::Bucket {
                address: address.clone(),
                message: e.to_string(),
            })?;
        Ok(Self {
            store,
            address,
            endpoint: endpoint.unwrap_or_else(|| "Amazon".into()),
            has_credentials,
        })
    }

    /// Copies the required files and returns their number and bytes.
    async fn copy(&self, needed: Needed, to: &Path) -> Result<(usize, u64), FleetError> {
        let prefix = Key::parse(&self.address.prefix).map_err(|e| self.store_error(&e.into()))?;
        let mut listed = self.store.list(Some(&prefix));
        let mut objects: Vec<(ObjectMeta, PathBuf)> = Vec::new();
        let mut is_empty = true;
        loop {
            let next = tokio::time::timeout(LIST_TIMEOUT, listed.try_next()).await;
            let next = next.map_err(|_| self.silent())?;
            let object = match next {
                Ok(Some(object)) => object,
                Ok(None) => break,
                Err(error) => return Err(self.unlisted(error, &prefix).await),
            };
            is_empty = false;
            let parts: Option<Vec<_>> =
                object.location.prefix_match(&prefix).map(Iterator::collect);
            let parts: Vec<&str> = parts.iter().flatten().map(AsRef::as_ref).collect();
            if let Some(place) = needed.place(&parts) {
                objects.push((object, to.join(place)));
            }
        }
        if is_empty {
            return Err(FleetError::EmptyPrefix(self.address.clone()));
        }
        let (files, bytes) = (
            objects.len(),
            objects.iter().map(|(object, _)| object.size).sum(),
        );
        stream::iter(objects)
            .map(|(object, place)| self.file(object, place))
            .buffer_unordered(MAX_CONCURRENT_FILES)
            .try_collect::<()>()
            .await?;
        Ok((files, bytes))
    }

    async fn file(&self, object: ObjectMeta, place: PathBuf) -> Result<(), FleetError> {
        let folder = sinew_files::folder_of(&place);
        std::fs::create_dir_all(folder).map_err(|source| FleetError::Folder {
            path: folder.into(),
            source,
        })?;
        let answer = self.store.get(&object.location).await;
        let mut bytes = answer.map_err(|e| self.wrong(e))?.into_stream();
        let mut file = AtomicFile::create(&place)?;
        let written = |source| sinew_files::OutputError {
            path: place.clone(),
            source,
        };
        while let Some(part) = bytes.try_next().await.map_err(|e| self.wrong(e))? {
            file.write_all(&part).map_err(written)?;
        }
        file.finish()?;
        Ok(())
    }

    fn silent(&self) -> FleetError {
        FleetError::Unreachable {
            address: self.address.clone(),
            endpoint: self.endpoint.clone(),
        }
    }

    /// Determines why a folder cannot be listed. Listing errors have no kind; therefore a file is requested, which reveals a
    /// missing bucket.
    async fn unlisted(&self, error: Error, prefix: &Key) -> FleetError {
        let error = self.wrong(error);
        if !matches!(error, FleetError::Bucket { .. }) {
            return error;
        }
        let probe = prefix.clone().join(SIDES[0]);
        match tokio::time::timeout(LIST_TIMEOUT, self.store.head(&probe)).await {
            Ok(Err(Error::NotFound { .. })) => FleetError::NoBucket {
                address: self.address.clone(),
                endpoint: self.endpoint.clone(),
            },
            Ok(Err(Error::PermissionDenied { .. } | Error::Unauthenticated { .. })) => {
                FleetError::Forbidden(self.address.clone())
            }
            _ => error,
        }
    }

    /// Classifies an error of the store.
    fn wrong(&self, error: Error) -> FleetError {
        let address = self.address.clone();
        match error {
            Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => {
                FleetError::Forbidden(address)
            }
            _ if !self.has_credentials => FleetError::NoCredentials(address),
            error if is_unreachable(&error) => self.silent(),
            error => self.store_error(&error),
        }
    }

    fn store_error(&self, error: &Error) -> FleetError {
        FleetError::Bucket {
            address: self.address.clone(),
            message: error.to_string(),
        }
    }
}

/// Whether the endpoint did not respond.
fn is_unreachable(error: &(dyn std::error::Error + 'static)) -> bool {
    let mut at = Some(error);
    while let Some(error) = at {
        if let Some(http) = error.downcast_ref::<HttpError>() {
            return matches!(http.kind(), HttpErrorKind::Connect | HttpErrorKind::Timeout);
        }
        at = error.source();
    }
    false
}

impl Needed {
    /// Returns the path of a file in the copy from its components below the folder; `None` if it is not needed.
    fn place(self, parts: &[&str]) -> Option<PathBuf> {
        // Hidden files are not part of a folder, and no name may point outside the copy.
        let plain =
            |part: &&str| !part.is_empty() && !part.starts_with('.') && !part.contains('\\');
        if !parts.iter().all(plain) {
            return None;
        }
        let (name, folders) = parts.split_last()?;
        let ending = Path::new(name).extension().and_then(|e| e.to_str());
        let needed = match self {
            Self::Baselines => ending == Some(BASELINES),
            Self::Records => {
                let stem = name.strip_suffix(".csv");
                ending == Some(RECORDS)
                    || folders.is_empty() && stem.is_some_and(|stem| SIDES.contains(&stem))
                    || folders.first() == Some(&TYPES)
            }
        };
        needed.then(|| parts.iter().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copy_selects_needed_files_inside_folder() {
        let place = |needed: Needed, key: &str| {
            let parts: Vec<&str> = key.split('/').collect();
            needed.place(&parts).is_some()
        };
        for kept in [
            "records/robot_type=a/month=2024-01/x-1.parquet",
            "tendons.csv",
            "types/a/robot.toml",
        ] {
            assert!(place(Needed::Records, kept), "{kept}");
            assert!(!place(Needed::Baselines, kept), "{kept}");
        }
        for left in [
            "truth/tendons.csv",
            "notes.csv",
            "records/.x.parquet",
            "../x.parquet",
            "records/../../x.parquet",
            "a//x.parquet",
            "x.baseline",
        ] {
            assert!(!place(Needed::Records, left), "{left}");
        }
        assert!(place(Needed::Baselines, "baselines/arm-1.baseline"));
    }
}
