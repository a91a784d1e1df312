#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| takt_fuzz::targets::fit_drive(bytes));
