use rastray::{gl, lanes::{Isa,Real}, lighting::*};
fn run<R: Real>(name:&str, lights:&[gl::LightSource], mat:&gl::Material, record: bool){
    let model = gl::LightModel::default();
    let rig = Rig::<R>::new(lights,&model);
    let mut pts = Points::<R>::default();
    let mut s=12345u64; let mut rnd=||{ s=s.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407); (s>>33) as f64/(1u64<<31) as f64*2.0-1.0};
    for _ in 0..1024 { let p=[rnd()*3.0,rnd()*3.0,-6.0+rnd()]; let n=rastray::math::float::normalize([rnd()*0.5,rnd()*0.5,1.0]).0; let v=rastray::math::float::normalize(p.map(|x|-x)).0;
      pts.push(p.map(R::from_f64),n.map(R::from_f64),v.map(R::from_f64)); }
    for isa in Isa::available() {
        let mut out=<[Vec<R>;3]>::default(); let mut rec=Vec::new();
        let reps = if isa<=Isa::Sse42 {20} else {200};
        let mut best=f64::MAX;
        for _ in 0..15 { let t=std::time::Instant::now();
            for _ in 0..reps { if record {shade(isa,&rig,mat,&pts,None,false,Sink::Record(&mut rec));} else {shade(isa,&rig,mat,&pts,None,false,Sink::Sum(&mut out));} }
            best=best.min(t.elapsed().as_secs_f64()/reps as f64); }
        println!("{} {name} {} {:.2} ns/point-light", R::NAME, isa.name(), best*1e9/1024.0/lights.len() as f64);
    }
}
#[test] fn bench(){
    let base=gl::LightSource{position:[1.0,2.0,3.0,1.0],ambient:[0.1;3],diffuse:[0.7;3],specular:[0.5;3],..Default::default()};
    let many=|f:&dyn Fn(usize)->gl::LightSource|->Vec<_>{(0..8).map(f).collect()};
    let pos=|i:usize|{let i=i as f64;[i-4.0,3.0-i*0.3,2.0+i*0.2,1.0]};
    let pt=many(&|i|gl::LightSource{position:pos(i),..base.clone()});
    let at=many(&|i|gl::LightSource{position:pos(i),attenuation:[1.0,0.1,0.01],..base.clone()});
    let sp=many(&|i|gl::LightSource{position:pos(i),attenuation:[1.0,0.1,0.01],spot_cutoff_deg:50.0,spot_exponent:10.0,..base.clone()});
    let di=many(&|i|gl::LightSource{position:{let mut p=pos(i);p[3]=0.0;p},..base.clone()});
    let m=gl::Material{specular:[0.5;3],shininess:32.0,..Default::default()};
    let md=gl::Material::default();
    run::<f32>("attenuated+specular",&at,&m,false);
    run::<f32>("attenuated+specular record",&at,&m,true);
    run::<f32>("point+specular",&pt,&m,false);
    run::<f32>("directional+specular",&di,&m,false);
    run::<f32>("directional diffuse",&di,&md,false);
    run::<f32>("spot+specular",&sp,&m,false);
    run::<f64>("attenuated+specular",&at,&m,false);
}
