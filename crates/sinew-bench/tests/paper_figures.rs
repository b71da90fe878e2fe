//! The figures of the paper, each made once for all tests.

use sinew_bench::paper::{self, PaperFigure};
use sinew_model::robot::Robot;
use sinew_rope::Catalogue;
use std::sync::OnceLock;

pub(crate) fn biorob_like() -> Robot {
    paper::shipped_robot().expect("the shipped robot is readable")
}

pub(crate) fn catalogue() -> Catalogue {
    Catalogue::shipped().expect("shipped ropes")
}

macro_rules! once {
    ($($name:ident from $what:ident;)*) => {$(
        pub(crate) fn $name() -> &'static PaperFigure {
            static FIGURE: OnceLock<PaperFigure> = OnceLock::new();
            FIGURE.get_or_init(|| paper::$name(&$what()).expect("made"))
        }
    )*};
}

once! {
    table1 from catalogue;
    fig1 from catalogue;
    fig2 from catalogue;
    fig4 from catalogue;
    fig5 from catalogue;
    fig6 from biorob_like;
    fig7 from biorob_like;
}
