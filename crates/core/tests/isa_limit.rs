//! The limit that `SPECTRA_ISA` sets holds in the whole process. This test is a program of its own, because the limit cannot be
//! taken back.

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
    // A limit does not hide what the machine has: `by_name` still accepts its names.
    let widest = machine[machine.len() - 1];
    assert_eq!(Isa::by_name(widest.name()), Ok(widest));
}
