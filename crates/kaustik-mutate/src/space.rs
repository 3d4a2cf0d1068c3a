use glam::{DVec2, DVec3};
use kaustik_mcmc::Draws;
use kaustik_path::{BuilderSettings, PureSpecular, ScalarTarget};
use kaustik_scene::Scene;

/// The light paths of a scene: what kernels move in.
#[derive(Clone, Copy, Debug)]
pub struct PathSpace<'a> {
    /// Where the paths run.
    pub scene: &'a Scene,
    /// Shortest and longest path, law of the wavelengths, window of the raster.
    pub settings: BuilderSettings,
    /// The scalar of a path's colour that is its density.
    pub target: ScalarTarget,
    /// Columns and rows of the image: the unit of raster jitter.
    pub pixels: DVec2,
}

/// Where edges are so long lengths are measured in the scene's own unit.
const USUAL: std::ops::RangeInclusive<f64> = 1.0 / 64.0..=64.0;

impl PathSpace<'_> {
    /// Longest paths, in edges: walks have room for so many vertices set aside.
    pub const MOST_EDGES: u32 = 4096;

    /// The area in whose unit densities of vertices are: 1 in a scene of a usual size. In one of millimetres or of
    /// kilometres the product over a long path would leave the range of `f64` with the scene's own unit. What counts is
    /// how far vertices are from each other, not how far the ground reaches.
    #[inline]
    pub(crate) fn unit_area(&self) -> f64 {
        let length = self.scene.typical_length();
        if USUAL.contains(&length) {
            1.0
        } else {
            length * length
        }
    }

    /// Has `work` see the space at an instant, [`Path::time`](crate::Path::time): in a scene that stands there, so that
    /// whatever is asked of a path is answered for its time. Chains that stay at one instant are run within.
    #[inline]
    pub fn at<R>(&self, time: f64, work: impl FnOnce(&PathSpace<'_>) -> R) -> R {
        let (scene, here);
        let space = if self.scene.stands_at(time) {
            self
        } else {
            scene = self.scene.at(time);
            here = PathSpace {
                scene: &scene,
                ..*self
            };
            &here
        };
        work(space)
    }

    /// A time for a path, if anything moves; else no number is drawn.
    #[inline]
    pub(crate) fn draw_time<D: Draws + ?Sized>(&self, draws: &mut D) -> f64 {
        if self.scene.moves() {
            draws.uniform()
        } else {
            0.0
        }
    }

    /// How many edges paths may have.
    #[inline]
    pub(crate) fn lengths(&self) -> std::ops::RangeInclusive<usize> {
        self.settings.min_edges as usize..=self.settings.max_edges as usize
    }

    /// Is a path made whose vertices between its ends scatter so, true for into a Dirac direction?
    #[inline]
    pub(crate) fn admits(&self, mut specular: impl Iterator<Item = bool>) -> bool {
        let rule = self.settings.pure_specular;
        rule == PureSpecular::Kept || rule.admits(specular.all(|specular| specular))
    }

    /// Density of a raster point: uniform over the window.
    #[inline]
    pub(crate) fn raster_pdf(&self) -> f64 {
        self.settings.raster_pdf()
    }

    /// Does the window hold this raster point?
    #[inline]
    pub(crate) fn serves(&self, raster: DVec2) -> bool {
        self.settings.serves(raster)
    }

    /// Has the lens area, so that a path may be given another point of it?
    #[inline]
    pub(crate) fn has_aperture(&self) -> bool {
        self.scene.camera().has_aperture()
    }

    /// Raster area per solid angle of a direction from the lens; of parallel rays per area across them.
    #[inline]
    pub(crate) fn raster_per_direction(&self, lens: DVec3, direction: DVec3) -> f64 {
        let camera = self.scene.camera();
        if camera.is_dirac_direction() {
            camera.raster_density(lens, lens + direction)
        } else {
            camera.pdf_direction(direction)
        }
    }

    /// Size of a pixel in the middle of the image, seen at a distance.
    pub(crate) fn footprint(&self, distance: f64) -> f64 {
        let camera = self.scene.camera();
        let (position, forward) = (camera.position(), camera.forward());
        let per_pixel =
            self.raster_per_direction(position, forward) * self.pixels.element_product();
        let distance = if camera.is_dirac_direction() {
            1.0
        } else {
            distance
        };
        distance / per_pixel.sqrt()
    }
}
