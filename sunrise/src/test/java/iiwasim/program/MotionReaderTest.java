package iiwasim.program;

import static org.junit.Assert.assertArrayEquals;
import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertFalse;
import static org.junit.Assert.assertNull;
import static org.junit.Assert.assertTrue;
import static org.junit.Assert.fail;

import org.junit.Test;

public class MotionReaderTest {
    private static final String CELL =
        "\"tools\":{\"gripper\":{\"tcp\":{\"z_mm\":120},\"tips\":{\"left\":{\"x_mm\":5}}}},"
        + "\"tool\":\"gripper\","
        + "\"bases\":{\"table\":{\"x_mm\":500},\"tray\":{\"base\":\"table\",\"y_mm\":10}},"
        + "\"frames\":{\"pick\":{\"base\":\"tray\",\"x_mm\":0,\"y_mm\":0,\"z_mm\":150,"
        + "\"a_deg\":0,\"b_deg\":180,\"c_deg\":0,\"e1_deg\":90,\"status\":2}},";

    private static MotionList read(String motions) throws Refusal {
        String text = "{" + CELL + "\"motions\":[" + motions.replace('\'', '"') + "]}";
        Keys keys = new Keys(Keys.parse(text), "");
        return MotionReader.read(keys, Keys.parse(text));
    }

    private static Motion one(String motion) throws Refusal {
        return read(motion).motions().get(0);
    }

    private static void assertRefused(String motions, String part) {
        try {
            read(motions);
        } catch (Refusal refusal) {
            assertEquals(Refusal.Code.BAD_REQUEST, refusal.code());
            assertTrue(refusal.getMessage(), refusal.getMessage().contains(part));
            return;
        }
        fail(motions);
    }

    @Test
    public void pointToPointMotions() throws Refusal {
        Motion motion =
            one("{'type':'ptp','joints_deg':[90,0,0,0,0,0,0],'velocity_rel':0.5,"
                + "'blend':{'fraction':0.25}}");
        assertEquals(Math.PI / 2, motion.jointsRad[0], 1e-12);
        assertArrayEquals(
            new double[] {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5}, motion.limits.velocityRel(), 0);
        assertNull(motion.limits.jerkRel());
        // A relative size of 1 in Sunrise is half of a motion.
        assertEquals(0.5, motion.blend.sunriseRel(), 0);
        assertEquals("gripper", motion.tcp.toString());
    }

    @Test
    public void blockingMotionsEndInAStop() throws Refusal {
        assertTrue(one("{'type':'ptp','joints_deg':[90,0,0,0,0,0,0],'blocking':true}").blocking);
        assertTrue(one("{'type':'lin','frame':'pick','blocking':true}").blocking);
        assertFalse(one("{'type':'lin','frame':'pick'}").blocking);
        assertRefused(
            "{'type':'lin','frame':'pick','blocking':1}", "`blocking` has to be true or false");
        assertRefused("{'type':'lin','frame':'pick','blocking':true,'blend':{'cart_mm':30}}",
            "cannot be blended");
        assertRefused("{'type':'wait','seconds':1,'blocking':true}", "unknown key `blocking`");
    }

    @Test
    public void framesAreResolved() throws Refusal {
        Motion motion =
            one("{'type':'lin','frame':'pick','tool':'gripper/left','cart_velocity_mm_s':250,"
            + "'orientation_velocity_deg_s':90,'blend':{'cart_mm':30,'ori_deg':10}}");
        assertArrayEquals(new double[] {500, 10, 150}, motion.frame.pose().xyzMm(), 1e-9);
        assertEquals(Math.PI / 2, motion.frame.e1Rad(), 1e-12);
        assertEquals(2, motion.frame.status().intValue());
        assertNull(motion.frame.turn());
        assertEquals(Math.PI / 2, motion.limits.orientationVelocity(), 1e-12);
        assertEquals("gripper/left", motion.tcp.toString());
        assertEquals(30, motion.blend.cartMm(), 0);
    }

    @Test
    public void splinesAndCircles() throws Refusal {
        String frame = "{'x_mm':1,'y_mm':2,'z_mm':3,'a_rad':0,'b_rad':0,'c_rad':0}";
        Motion spline =
            one("{'type':'spline','segments':[{'type':'spl','frame':'pick','orientation':'ignore'},"
            + "{'type':'circ','aux':" + frame
            + ",'frame':'pick','orientation_reference':'path'}]}");
        assertEquals(2, spline.segments.size());
        assertTrue(spline.segments.get(1).turnsWithPath);
        Motion relative = one("{'type':'lin_rel','offset':{'z_mm':-5},'in':'tcp','e1_deg':90}");
        assertNull(relative.in);
        assertEquals(Math.PI / 2, relative.e1Rad, 1e-12);
    }

    @Test
    public void changesOfTheLoad() throws Refusal {
        assertEquals(Motion.Type.LOAD, one("{'type':'load','load':null}").type);
        assertFalse(one("{'type':'load','load':{'mass_kg':2,'center_mm':[0,0,9]}}").isPath());
        assertRefused("{'type':'load'}", "`load` is missing");
        assertRefused("{'type':'load','load':{'mass_kg':-1}}", "`mass_kg`");
        assertRefused(
            "{'type':'load','load':{'mass_kg':1,'inertia_kg_m2':[0,-1,0]}}", "`inertia_kg_m2`");
        assertRefused(
            "{'type':'lin','frame':'pick','blend':{'cart_mm':30}},{'type':'load','load':null}",
            "change of the load");
    }

    @Test
    public void whatIsWrongIsNamed() {
        assertRefused("{'type':'fly'}", "`fly`");
        assertRefused("{'type':'ptp'}", "motion 1");
        assertRefused("{'type':'ptp','frame':'pik'}", "unknown frame `pik`");
        assertRefused("{'type':'ptp','joints_deg':[0,0,0,0,0,0,0],'speed':1}", "`speed`");
        assertRefused("{'type':'wait','seconds':1},{'type':'wait','seconds':-1}", "motion 2");
        assertRefused("{'type':'lin','frame':'pick','blend':{'fraction':0.1}}", "`fraction`");
        assertRefused("{'type':'lin','frame':'pick','orientation':'ignore'}", "`ignore`");
        assertRefused("{'type':'circ','frame':'pick'}", "`aux`");
        assertRefused("{'type':'spline','segments':[]}", "`segments`");
        assertRefused(
            "{'type':'lin','frame':'pick','blend':{'cart_mm':30}},{'type':'wait','seconds':1}",
            "wait");
        assertRefused("{'type':'lin','frame':'pick','cart_acceleration_mm_s2':0.5}", "at least 1");
        assertRefused("{'type':'lin','frame':'pick','tool':'drill'}", "unknown tool `drill`");
        assertRefused("{'type':'lin','frame':'pick','base':'shelf'}", "unknown base `shelf`");
    }

    @Test
    public void waitsDuringWhichTheArmMovesAreRefused() throws Refusal {
        String motion = "{'type':'ptp','joints_deg':[0,0,0,0,0,0,0],'blend':{'fraction':0.1}},";
        assertRefused(motion + "{'type':'wait','seconds':1,'overlap':true}", "motion 2: `overlap`");
        assertRefused(
            motion + "{'type':'wait','seconds':1,'overlap_motions':1}", "motion 2: `overlap`");
        assertRefused("{'type':'wait','seconds':1,'overlap':1}", "true or false");
        assertEquals(1, one("{'type':'wait','seconds':1,'overlap':false}").seconds, 0);
    }

    @Test
    public void basesThatAreGivenInThemselves() {
        String text = "{\"bases\":{\"a\":{\"base\":\"b\"},\"b\":{\"base\":\"a\"}},\"base\":\"a\","
            + "\"motions\":[{\"type\":\"wait\",\"seconds\":1}]}";
        try {
            MotionReader.read(new Keys(Keys.parse(text), ""), Keys.parse(text));
            fail();
        } catch (Refusal refusal) {
            assertTrue(refusal.getMessage(), refusal.getMessage().contains("refers to itself"));
        }
    }
}
