//! Lists of keywords by their meaning for a lens.

/// Records of a surface that are read.
const SURFACE_READ: [&str; 31] = [
    "TYPE", "CURV", "DISZ", "GLAS", "CONI", "PARM", "XDAT", "STOP", "DIAM", "MEMA", "CLAP", "FLAP", "OBSC", "SQAP",
    "SQOB", "ELAP", "ELOB", "USAP", "USOB", "UDAP", "UDAD", "UDOB", "SPID", "OBDC", "COMM", "COAT", "SCBD", "PPAR",
    "PZUP", "PKUP", "IGNR",
];

/// Records of a surface that only define how it is drawn, named, varied or toleranced.
const SURFACE_HARMLESS: [&str; 30] = [
    "SSID", "FIMP", "HIDE", "MIRR", "SLAB", "POPS", "OEMA", "CHZN", "OHZN", "VDSZ", "VPAR", "VCUR", "VCON", "VXDA",
    "SCOL", "SOPA", "RCOL", "DRAW", "TCEX", "MCHZ", "SCHZ", "VGLA", "VDIA", "SUPC", "COFR", "CDRW", "TOLE", "TCED",
    "EDGE", "TCMM",
];

/// Records of the system that are read elsewhere, or only define how it is computed, drawn or toleranced.
const SYSTEM_HARMLESS: [&str; 48] = [
    "VERS", "DBDT", "AUTH", "IWDP", "STUD", "PFIL", "LANG", "GFAC", "RAIM", "PUSH", "SDMA", "OMMA", "ROPD", "HYPR",
    "PICB", "FWGN", "POLS", "GLRS", "GSTD", "NSCD", "COFN", "LUID", "EERA", "BLNK", "MODE", "UNIT", "FTYP", "XFLN",
    "YFLN", "XFLD", "YFLD", "FWGT", "WAVM", "WAVL", "WAVN", "WWGT", "WWGN", "PWAV", "ENPD", "FNUM", "OBNA", "FLOA",
    "NAME", "GCAT", "NOTE", "ENVD", "TEMP", "PRES",
];

/// Vignetting factors, which select rays but block none.
const VIGNETTING: [&str; 9] = ["VDXN", "VDYN", "VCXN", "VCYN", "VANN", "ZVCX", "ZVCY", "ZVDX", "ZVDY"];

fn in_list(list: &[&str], keyword: &str) -> bool {
    list.iter().any(|known| known.eq_ignore_ascii_case(keyword))
}

/// Whether a keyword belongs to a surface.
pub(super) fn is_of_surface(keyword: &str) -> bool {
    in_list(&SURFACE_READ, keyword) || in_list(&SURFACE_HARMLESS, keyword)
}

/// Whether a record of a surface needs no note.
pub(super) fn is_harmless_on_surface(keyword: &str) -> bool {
    in_list(&SURFACE_HARMLESS, keyword)
}

/// Whether a record of the system is read elsewhere or needs no note.
pub(super) fn is_harmless_in_system(keyword: &str) -> bool {
    in_list(&SYSTEM_HARMLESS, keyword)
}

/// Whether a keyword is a vignetting factor.
pub(super) fn is_vignetting(keyword: &str) -> bool {
    in_list(&VIGNETTING, keyword)
}
