/// What a file may cost. The defaults suit files of unknown origin.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct LoadOptions {
    /// Most bytes that loading may hold at a time, as counted before they are allocated;
    /// `None`: 1 GiB plus 64 times the bytes of the files that are read.
    pub max_memory: Option<u64>,
    /// Most instances (placements of a mesh) in the scene.
    pub max_instances: usize,
    /// Most nodes from a root to a leaf.
    pub max_depth: usize,
    /// Most bytes of one file, the scene's own or one that it names.
    pub max_file: u64,
    /// Most columns and most rows of an image.
    pub max_image_side: u32,
    /// Which of the file's material variants (`KHR_materials_variants`) to show, by name;
    /// `None`: each primitive's own material.
    pub variant: Option<String>,
}

impl Default for LoadOptions {
    fn default() -> Self {
        Self {
            max_memory: None,
            max_instances: 4_000_000,
            max_depth: 4096,
            max_file: u32::MAX.into(),
            max_image_side: 32_768,
            variant: None,
        }
    }
}

impl LoadOptions {
    /// These options with at most `bytes` held at a time.
    #[must_use]
    pub fn with_max_memory(mut self, bytes: u64) -> Self {
        self.max_memory = Some(bytes);
        self
    }

    /// These options with the material variant of this name.
    #[must_use]
    pub fn with_variant(mut self, name: impl Into<String>) -> Self {
        self.variant = Some(name.into());
        self
    }
}
