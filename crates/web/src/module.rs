//! What the module gives to the worker.
#![allow(unsafe_code)] // names without mangling, and the one call that registers the stages

use crate::Desk;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

#[derive(Default)]
struct Module {
    inbox: Vec<u8>,
    outbox: Vec<u8>,
    desk: Desk,
}

static MODULE: LazyLock<Mutex<Module>> = LazyLock::new(Mutex::default);

fn module() -> MutexGuard<'static, Module> {
    MODULE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// To be called once, before anything else: registers the stages of all plugins.
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    #[cfg(target_family = "wasm")]
    {
        unsafe extern "C" {
            fn __wasm_call_ctors();
        }
        // SAFETY: the linker makes this function of the module's own static constructors. A module that calls it itself is not
        // given further calls of it, and the worker says `start` once.
        unsafe { __wasm_call_ctors() }
    }
}

/// Room for a request of so many bytes.
#[unsafe(no_mangle)]
pub extern "C" fn inbox(bytes: usize) -> *mut u8 {
    let mut module = module();
    module.inbox.clear();
    module.inbox.resize(bytes, 0);
    module.inbox.as_mut_ptr()
}

/// Answers the request in the inbox; the length of the answer, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn call() -> usize {
    let module = &mut *module();
    module.outbox = module.desk.answer(&module.inbox);
    module.outbox.len()
}

/// The last answer.
#[unsafe(no_mangle)]
pub extern "C" fn outbox() -> *const u8 {
    module().outbox.as_ptr()
}
