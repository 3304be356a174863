//! Functions that the module exports to the worker.
#![allow(unsafe_code)] // names without mangling, and the one call that registers the stages

use crate::RequestHandler;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

#[derive(Default)]
struct Module {
    inbox: Vec<u8>,
    outbox: Vec<u8>,
    desk: RequestHandler,
}

static MODULE: LazyLock<Mutex<Module>> = LazyLock::new(Mutex::default);

fn module() -> MutexGuard<'static, Module> {
    MODULE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Registers the stages of all plugins. The worker must call it once, before anything else.
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    #[cfg(target_family = "wasm")]
    {
        unsafe extern "C" {
            fn __wasm_call_ctors();
        }
        // SAFETY: the linker creates this function from the static constructors of the module. Because the module calls it
        // explicitly, the linker adds no other calls, and the worker calls `start` only once.
        unsafe { __wasm_call_ctors() }
    }
}

/// Clears the inbox, makes room for a request of `bytes` bytes, and returns a pointer to that room.
#[unsafe(no_mangle)]
pub extern "C" fn inbox(bytes: usize) -> *mut u8 {
    let mut module = module();
    module.inbox.clear();
    module.inbox.resize(bytes, 0);
    module.inbox.as_mut_ptr()
}

/// Answers the request in the inbox, puts the answer into the outbox, and returns its length in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn call() -> usize {
    let module = &mut *module();
    module.outbox = module.desk.answer(&module.inbox);
    module.outbox.len()
}

/// Returns a pointer to the outbox, which holds the answer to the last [`call`].
#[unsafe(no_mangle)]
pub extern "C" fn outbox() -> *const u8 {
    module().outbox.as_ptr()
}
