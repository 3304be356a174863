//! Tests that no command overwrites a file that it reads.

use crate::common::{run, run_in, shown, text};
use image::{Rgb, RgbImage};

const SCENE: &str = "spectra: 1\nsource: {kind: picture, file: plate.png, distance: 2 m, width: fill}\n\
    lens: {file: zeiss-biotar-50-f1.4, focus: 2 m}\nimager: {kind: xyz, format: 135, resolution: [12, 8]}\n\
    render: {samples: 1}\noutput: [png]\n";

#[test]
fn no_command_writes_over_what_it_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    RgbImage::from_pixel(12, 8, Rgb([90, 120, 150])).save(at("plate.png")).expect("written");
    std::fs::write(at("plate.yaml"), SCENE).expect("written");
    std::fs::write(at("rays.csv"), "x_mm,y_mm,z_mm,l,m,n,wavelength_nm\n0,1,-5,0,0,1,550\n").expect("written");
    let zmx = run(&["lens", "export", "helios", "-o", shown(&at("lens.zmx"))]);
    assert!(zmx.status.success(), "{}", text(&zmx.stderr));
    let read =
        || ["plate.png", "plate.yaml", "rays.csv", "lens.zmx"].map(|name| std::fs::read(at(name)).expect("there"));
    let before = read();
    let run = |arguments: &[&str]| {
        let output = run_in(folder.path(), arguments);
        (output.status.code(), text(&output.stderr))
    };
    for arguments in [
        &["run", "plate.yaml", "-o", "."][..],
        &["run", "plate.yaml", "-o", "./plate.png"],
        &["film", "develop", "plate.png", "--stock", "tri-x", "-o", "plate.png"],
        &["lens", "trace", "helios", "--rays", "rays.csv", "-o", "rays.csv"],
        &["lens", "import", "lens.zmx", "-o", "lens.zmx", "--force"],
        &["lens", "export", "lens.zmx", "-o", "lens.zmx", "--force"],
        &["picture", "plot", "plate.png", "-o", "plate.png"],
        &["picture", "cut", "plate.png", "--row", "3", "-o", "plate.png"],
        &["picture", "compare", "plate.png", "plate.png", "-o", "plate.png"],
    ] {
        let (code, said) = run(arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(said.contains("would be overwritten"), "{arguments:?}: {said}");
        assert!(before == read(), "{arguments:?}");
    }
    let (code, said) = run(&["run", "plate.yaml", "-o", "out"]);
    assert_eq!(code, Some(0), "{said}");
}
