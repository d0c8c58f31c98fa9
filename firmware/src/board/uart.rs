//! The double of a bus between two emulated boards: the first UART of an MPS2, as a CAN driver.
//!
//! Its registers are those of ARM's APB UART (Cortex-M System Design Kit, DDI 0479). An interrupt
//! takes each byte that arrives; a byte that is sent waits for the one before it.

use core::cell::RefCell;
use core::convert::Infallible;
use cortex_m::interrupt::{InterruptNumber, Mutex, free};
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use heapless::Deque;
use nodes::WireFrame;
use nodes::serial_line::{Reader, write};

const DATA: usize = 0x4000_4000;
const STATE: usize = DATA + 0x4;
const CONTROL: usize = DATA + 0x8;
const INTERRUPTS: usize = DATA + 0xC;
const DIVIDER: usize = DATA + 0x10;

/// Bits of `STATE`.
const SENDS: u32 = 1;
const HAS_RECEIVED: u32 = 1 << 1;

/// Bits of `CONTROL`: both directions, and the interrupt of a byte that has arrived.
const ON: u32 = 1 | 1 << 1 | 1 << 3;

/// The bit of `INTERRUPTS` for a byte that has arrived.
const RECEIVED: u32 = 1 << 1;

/// The smallest divider: the emulator has no bit rate.
const FASTEST: u32 = 16;

/// Reads of `STATE` before a byte is given up that cannot be sent.
const PATIENCE: u32 = 10_000_000;

/// Bytes that have arrived; more than all other nodes send in two ticks.
static ARRIVED: Mutex<RefCell<Deque<u8, 512>>> = Mutex::new(RefCell::new(Deque::new()));

#[derive(Clone, Copy)]
struct HasReceived;

#[expect(unsafe_code, reason = "the number of an interrupt that the board has")]
unsafe impl InterruptNumber for HasReceived {
    fn number(self) -> u16 {
        0
    }
}

#[expect(unsafe_code, reason = "a register of the board, by its address")]
fn read(register: usize) -> u32 {
    unsafe { (register as *const u32).read_volatile() }
}

#[expect(unsafe_code, reason = "a register of the board, by its address")]
fn put(register: usize, value: u32) {
    unsafe { (register as *mut u32).write_volatile(value) }
}

/// The only interrupt of a device that is on.
#[allow(unsafe_code, reason = "it handles all interrupts; the macro makes two functions of it")]
#[exception]
unsafe fn DefaultHandler(_number: i16) {
    put(INTERRUPTS, RECEIVED);
    if read(STATE) & HAS_RECEIVED != 0 {
        let byte = read(DATA) as u8;
        free(|key| {
            if let Ok(mut arrived) = ARRIVED.borrow(key).try_borrow_mut() {
                // One that finds no room is lost, and its frame with it.
                let _full = arrived.push_back(byte);
            }
        });
    }
}

/// The line to the other board.
pub struct Uart(Reader);

impl Uart {
    /// Switches it on.
    pub fn start() -> Self {
        put(DIVIDER, FASTEST);
        put(CONTROL, ON);
        #[expect(unsafe_code, reason = "its handler is there")]
        unsafe {
            NVIC::unmask(HasReceived);
        }
        Self(Reader::default())
    }
}

impl embedded_can::nb::Can for Uart {
    type Frame = WireFrame;
    type Error = Infallible;

    fn transmit(&mut self, frame: &WireFrame) -> nb::Result<Option<WireFrame>, Infallible> {
        write(frame, |byte| {
            let is_free = (0..PATIENCE).any(|_| read(STATE) & SENDS == 0);
            if is_free {
                put(DATA, u32::from(byte));
            }
        });
        Ok(None)
    }

    fn receive(&mut self) -> nb::Result<WireFrame, Infallible> {
        loop {
            let byte = free(|key| ARRIVED.borrow(key).try_borrow_mut().ok()?.pop_front());
            let byte = byte.ok_or(nb::Error::WouldBlock)?;
            if let Some(frame) = self.0.take(byte) {
                return Ok(frame);
            }
        }
    }
}
