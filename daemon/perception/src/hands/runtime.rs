//! ONNX Runtime and the model files: checked, then loaded.

use crate::error::{PerceptionError, RuntimeFile};
use ort::environment::Environment;
use ort::session::Session;
use ort::session::builder::GraphOptimizationLevel;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The files that `models/provision.py` makes.
const CHECKSUMS: &str = include_str!("../../models/SHA256SUMS");
const LIBRARY: &str = "libonnxruntime.so";

/// One per process, for as long as it runs: ONNX Runtime allows no second one.
static ENVIRONMENT: Mutex<Option<Environment>> = Mutex::new(None);

/// Loads ONNX Runtime from a folder. A process that has loaded it keeps the one it has.
fn environment(folder: &Path) -> Result<Environment, PerceptionError> {
    let mut loaded = ENVIRONMENT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(environment) = &*loaded {
        return Ok(environment.clone());
    }
    let what = RuntimeFile::OnnxRuntime;
    // It is checked first, because loading a library that is cut short kills the process.
    let (path, _) = checked(folder, LIBRARY, what)?;
    let refused = |reason: String| PerceptionError::Refused { what, path: path.clone(), reason };
    let environment = ort::init_from(&path)
        .map_err(|error| refused(error.to_string()))?
        .with_name("andon")
        .build()
        .map_err(|error| refused(error.to_string()))?;
    *loaded = Some(environment.clone());
    Ok(environment)
}

/// Loads a model that runs in the caller's thread alone.
pub(super) fn session(folder: &Path, file: &str, what: RuntimeFile) -> Result<Session, PerceptionError> {
    let environment = environment(folder)?;
    let (path, bytes) = checked(folder, file, what)?;
    let load = || -> ort::Result<Session> {
        Session::builder(&environment)?
            .with_optimization_level(GraphOptimizationLevel::Level3)?
            .with_intra_threads(1)?
            .with_inter_threads(1)?
            .commit_from_memory(&bytes)
    };
    load().map_err(|error| PerceptionError::Refused { what, path, reason: error.to_string() })
}

/// The path and the bytes of a file that has its pinned checksum.
fn checked(folder: &Path, file: &str, what: RuntimeFile) -> Result<(PathBuf, Vec<u8>), PerceptionError> {
    let path = folder.join(file);
    let bytes = match std::fs::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            return Err(PerceptionError::Missing { what, path });
        }
        Err(source) => return Err(PerceptionError::Unreadable { what, path, source }),
    };
    let digest: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    let pinned = CHECKSUMS.lines().filter_map(|line| line.split_once("  ")).find(|(_, name)| *name == file);
    match pinned {
        Some((expected, _)) if expected == digest => Ok((path, bytes)),
        _ => Err(PerceptionError::Corrupt { what, path }),
    }
}
