// Figure 1 in POV-Ray's language, the peer that the figures are measured against. Same surfaces, lights, coefficients and
// depth; what differs is POV-Ray's phong term, which it weighs with the light but not with ks alone, and its pixel centres.
#version 3.7;
global_settings { assumed_gamma 1.0 max_trace_level 18 adc_bailout 1/512 ambient_light rgb 1 }

camera {
  perspective location <0, 30, -200> right -x * image_width / image_height up y angle 2 * degrees(atan(tan(radians(20)) * image_width / image_height))
  look_at <0, 10, -100>
}

light_source { <60, 160, -200> rgb 1 }
light_source { <-80, 160, -200> rgb 1 }

sphere { 0, 600
  // The sky of the texture, by height: s = 0.001 y + 0.12.
  pigment { gradient y color_map { [0 rgb <1, 0.6, 0.5>] [0.3 rgb <1, 1, 0.5>] [0.6 rgb <0.7, 1, 0.7>] [1 rgb <0.5, 0.8, 1>] } scale 1000 translate -120 * y }
  finish { ambient 0.8 diffuse 0 }
}

#declare Mirror = texture { pigment { rgb 1 } finish { ambient 0.11 diffuse 0.11 phong 0.3 phong_size 1000 reflection 0.7 } }
#macro Ball(P) sphere { P, 20 texture { Mirror } } #end
Ball(<0, 32.7, 0>) Ball(<-5.98, 0, -22.31>) Ball(<-16.32, 0, 16.32>) Ball(<22.31, 0, 5.98>)
Ball(<5.98, -32.66, 22.31>) Ball(<16.32, -32.66, -16.32>) Ball(<-22.31, -32.66, -5.98>) Ball(<-11.95, -32.66, -44.61>)
Ball(<-32.66, -32.66, 32.66>) Ball(<44.61, -32.66, 11.95>)

intersection {
  plane { y, -60 } plane { x, 300 } plane { -x, 300 } plane { -z, 300 } plane { z, 300 }
  pigment { checker rgb <0.08, 0.25, 0.20> rgb <0.93, 0.83, 0.82> scale 40 }
  finish { ambient 0.3 diffuse 0.4 reflection 0.3 }
}
