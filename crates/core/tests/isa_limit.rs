//! What `SPECTRA_ISA` asks for holds in the whole process. A test program of its own: the limit cannot be taken back.

use spectra_core::Isa;

#[test]
fn nothing_runs_wider_than_the_limit() {
    let machine = Isa::available();
    for (at, isa) in machine.iter().enumerate().rev() {
        isa.limit();
        assert_eq!(Isa::detect(), *isa);
        assert_eq!(Isa::available(), machine[..=at]);
        for wider in &machine[at..] {
            assert_eq!(wider.allowed(), *isa, "{}", wider.name());
        }
    }
    // A limit does not hide what the machine has: a name that is known is no fault.
    assert_eq!(Isa::by_name(machine[machine.len() - 1].name()).as_ref(), machine.last().ok_or(&String::new()));
}
