use std::fmt;
use std::str::FromStr;

/// What is broken, or planted to see that a campaign notices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Scene files: GLB, and glTF as text.
    Model,
    /// Textures as PNG,
    Png,
    /// as JPEG,
    Jpeg,
    /// and as WebP.
    Webp,
    /// Environment maps as Radiance HDR,
    Hdr,
    /// and as OpenEXR.
    Exr,
    /// A fault of our own: a child that panics,
    PlantedPanic,
    /// aborts,
    PlantedAbort,
    /// hangs,
    PlantedHang,
    /// or takes all memory.
    PlantedHunger,
}

const NAMES: [(Kind, &str); 10] = [
    (Kind::Model, "model"),
    (Kind::Png, "png"),
    (Kind::Jpeg, "jpeg"),
    (Kind::Webp, "webp"),
    (Kind::Hdr, "hdr"),
    (Kind::Exr, "exr"),
    (Kind::PlantedPanic, "planted-panic"),
    (Kind::PlantedAbort, "planted-abort"),
    (Kind::PlantedHang, "planted-hang"),
    (Kind::PlantedHunger, "planted-hunger"),
];

impl Kind {
    /// Those that a campaign breaks.
    pub(crate) const CAMPAIGN: [Self; 6] = [
        Self::Model,
        Self::Png,
        Self::Jpeg,
        Self::Webp,
        Self::Hdr,
        Self::Exr,
    ];

    pub(crate) fn name(self) -> &'static str {
        let row = NAMES.iter().find(|row| row.0 == self);
        row.map_or("", |row| row.1)
    }
}

impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let row = NAMES.iter().find(|row| row.1 == text);
        row.map(|row| row.0).ok_or_else(|| {
            let names: Vec<&str> = NAMES.iter().map(|row| row.1).collect();
            format!("expected one of {}", names.join(", "))
        })
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
