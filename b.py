import OpenEXR, numpy as np
def y(p):
    f=OpenEXR.File(p); c=f.channels(); k=[k for k in c if k.endswith('Y') or k=='RGB' or k=='XYZ'][0]; print(list(c)); v=c[k].pixels; return v if v.ndim==2 else v[...,1]
a,b=y('gout/g3.exr').astype(float),y('gout/s2/g3.exr').astype(float)
B=lambda v:v.reshape(40,32,60,32).mean(axis=(1,3))
A,C=B(a),B(b); m=(A+C)/2; d=np.abs(A-C)/np.sqrt(2)/m
ok=(m>1e-4*np.sort(m.ravel())[-3])  
print(ok.mean(), np.sqrt(np.mean(d[ok]**2)), np.median(d[ok]), np.percentile(d[ok],95))
