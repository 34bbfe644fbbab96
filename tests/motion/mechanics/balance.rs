//! Force and torque balance on three palms: appendix A.3.

use crate::mechanics::drawn::Dice;
use crate::mechanics::sheet::Sheet;
use palmistry::mechanics::*;

/// Appendix A.3: where the potential energy is stationary, the contacts tell where the centre of mass is.
#[test]
fn at_rest_the_contacts_tell_the_centre_of_mass() {
    let mut dice = Dice::new(98);
    let (mut worst, mut found) = (0.0f64, 0);
    for k in 0..60 {
        let shape = if k % 2 == found % 2 { dice.ellipsoid() } else { dice.bumpy() };
        let motion = dice.solid_motion(&shape);
        let palms: [_; 3] = std::array::from_fn(|i| palm_frame(&motion.azimuths[i], &motion.palms[i].value));
        let start = motion.frames(&Real::zero()).0;
        let Some((_, grip)) = resting_pose(&motion.solid, &palms, &start) else { continue };
        let mut sheet = Sheet::default();
        sheet.vector("cm", &grip.centre).define("let nz = [0; 0; 1]");
        for (i, palm) in palms.iter().enumerate() {
            sheet.vector(&format!("c{}", i + 1), &grip.contacts[i].world);
            sheet.vector(&format!("n{}", i + 1), &palm[2]);
        }
        sheet.define(
            "let volume = dot(cross(n1, n2), n3)\nlet f1 = dot(cross(n2, n3), nz)/volume
             let f2 = dot(cross(n3, n1), nz)/volume\nlet f3 = dot(cross(n1, n2), nz)/volume
             let moments = f1*cross(c1, n1) + f2*cross(c2, n2) + f3*cross(c3, n3)",
        );
        let mut sheet = sheet.open();
        sheet.holds("A.26", "f1*n1 + f2*n2 + f3*n3", "nz");
        sheet.holds(
            "A.27",
            "f1*cross(c1 - cm, n1) + f2*cross(c2 - cm, n2) + f3*cross(c3 - cm, n3)",
            "[0; 0; 0]",
        );
        sheet.holds("c_m1", "dot(cm, [1; 0; 0])", "-dot(moments, [0; 1; 0])");
        // print: the second component again, which would make c_m2 = -c_m1
        sheet.fails("c_m2 as printed", "dot(cm, [0; 1; 0])", "dot(moments, [0; 1; 0])");
        sheet.holds("c_m2", "dot(cm, [0; 1; 0])", "dot(moments, [1; 0; 0])");
        worst = worst.max(sheet.worst);
        found += 1;
        if found == 4 {
            break;
        }
    }
    assert_eq!(found, 4);
    println!("greatest difference {worst:e}");
}
