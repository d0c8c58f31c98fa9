//! How deep the stack was: what lies below it is painted, and what the paint has lost was in use.
//!
//! The stack grows down from the end of RAM. The statics lie at its beginning, so that a stack that
//! grows into them would be seen by the paint first.

/// What unused memory is filled with.
const PAINT: u32 = 0xcccc_cccc;

/// Words left below the frame that paints, for the calls it makes.
const SPARE: usize = 64;

/// The unused stack below the frame of the caller.
#[expect(unsafe_code, reason = "names of the linker, read for their addresses only")]
fn bounds() -> (usize, usize) {
    unsafe extern "C" {
        static _stack_end: u32;
        static _stack_start: u32;
    }
    (&raw const _stack_end as usize, &raw const _stack_start as usize)
}

/// Paints what lies below the caller.
#[inline(never)]
pub fn paint() {
    let mark = 0_u32;
    let here = &raw const mark as usize;
    let (mut at, _) = bounds();
    while at < here.saturating_sub(SPARE * size_of::<u32>()) {
        #[expect(unsafe_code, reason = "memory between the statics and the stack, used by nobody")]
        unsafe {
            (at as *mut u32).write_volatile(PAINT);
        }
        at += size_of::<u32>();
    }
}

/// Bytes of the stack that have been in use since it was painted, from the end of RAM.
pub fn deepest() -> usize {
    let (mut at, end) = bounds();
    while at < end {
        #[expect(unsafe_code, reason = "memory that is read as what it was painted with")]
        let word = unsafe { (at as *const u32).read_volatile() };
        if word != PAINT {
            break;
        }
        at += size_of::<u32>();
    }
    end - at
}
