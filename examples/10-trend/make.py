# Writes sessions.csv: two tendons that creep linearly in the logarithm of time, with correlated
# errors of the sessions, a drift with temperature, and a strand of the elbow that fails on 2026-05-05.
import math, random, datetime
random.seed(10)
day0 = datetime.datetime(2026, 3, 2, 6, 0)
out = ["time,robot,joint,offset_mrad,interval_95_mrad,temperature_c,baseline,stiffness_change_percent,stiffness_interval_95_percent"]
slow = {"shoulder_pitch": 0.0, "elbow": 0.0}
phi = math.exp(-1/20)
for d in range(0, 110):
    if d % 7 in (5, 6): continue          # no sessions on weekends
    t = day0 + datetime.timedelta(days=d, hours=1.5*random.random())
    days = d + 1.0
    temp = 20 + 5*math.sin(2*math.pi*(d-40)/365.25) + 1.5*random.gauss(0,1)
    for j, amp, drift in (("shoulder_pitch", 2.05, 0.12), ("elbow", 1.9, -0.08)):
        slow[j] = phi*slow[j] + 0.25*math.sqrt(1-phi*phi)*random.gauss(0,1)
        y = amp*math.log(days*24) + drift*(temp-18) + slow[j] + 0.3*random.gauss(0,1)
        stiff = 0.8*random.gauss(0,1)
        if j == "elbow" and d >= 64:
            y += 2.9; stiff -= 6.0
        row = [t.strftime("%Y-%m-%dT%H:%MZ"), "biorob-like", j, f"{y:.3f}", f"{0.9:.1f}", f"{temp:.1f}", "march.baseline", f"{stiff:.1f}", "2.5"]
        if d == 30: row[3] = row[4] = row[7] = row[8] = ""   # the arm was at rest
        out.append(",".join(row))
print("\n".join(out))
